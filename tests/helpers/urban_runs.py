"""The first part of the urban cycle on mixed surfaces, once for all tests of a file."""

from __future__ import annotations

from functools import cache

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_papers.dissertation.measures import traction_windows as cycle
from ev_stack.recording.offline import run_offline
from ev_stack.recording.recording import Recording
from ev_stack.scenarios.scenario import Overrides, Scenario, load_scenario

DURATION = 95.0  # s: stands, drives, slows down, stands, drives


def scenario(driver: str = "pulse") -> Scenario:
    """The scenario with a driver, and the speed that he needs."""
    speed = "imposed" if driver == "imposed_speed" else "free"
    return load_scenario(
        "urban_mixed", Overrides((), [("driver", "method", driver), ("plant", "speed", speed)])
    )


def parameters_of(loaded: Scenario) -> dict[str, dict]:
    """All parameters of its only run, by role and name."""
    return {
        role: configuration.values()
        for role, configuration in loaded.runs[0].configurations.items()
    }


PARAMETERS = parameters_of(scenario())
CAR: Vehicle = scenario().runs[0].configurations["plant"].common.vehicle


@cache
def driven(driver: str) -> Recording:
    """The signals of the run."""
    return run_offline(scenario(driver).runs[0].configurations, DURATION)


def modes(run: Recording) -> np.ndarray:
    """The mode of the cycle at each sample, (n,) str."""
    return cycle.modes_over_time(run, PARAMETERS["driver"])
