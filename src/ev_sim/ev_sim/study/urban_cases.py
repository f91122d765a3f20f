"""The five torque control methods of the dissertation in its urban cycle, with the three drivers."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from typing import Any

from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.parameters.declaration import ParameterError
from ev_sim.report.metric import NotMeasured
from ev_sim.report.quantities.cycle_efficiency import energies, slip_energy, wheel_sums
from ev_sim.run.recording.recording import Recording
from ev_sim.run.scenarios.scenario import Run
from ev_sim.study.case import Case

SCENARIO = "urban_mixed"
# Number of the method in chapter 3: electronic differential and ASR.
METHODS = {
    1: ("adaptive", "least_squares"),
    2: ("open_differential", "off"),
    3: ("limited_slip", "off"),
    4: ("limited_slip_variable", "off"),
    5: ("adhesion_share", "off"),
}
TITLES = {
    1: "adaptive",
    2: "open differential",
    3: "limited slip",
    4: "limited slip, variable",
    5: "by adhesion",
}
DRIVERS = ("tracking", "imposed_speed", "pulse")

Values = tuple[tuple[str, str, Any], ...]


def case(method: int, driver: str, seed: int, name: str = "", further: Values = ()) -> Case:
    """One cycle: number of the method, driver, seed of the road, and what else differs from the scenario."""
    differential, asr = METHODS[method]
    values: Values = (
        ("electronic_differential", "method", differential),
        ("asr", "method", asr),
        ("driver", "method", driver),
        ("plant", "speed", "imposed" if driver == "imposed_speed" else "free"),
        ("plant", "road.seed", seed),
    )
    return Case(name or case_name(method, driver, seed), SCENARIO, (*values, *further))


def roads(given: argparse.Namespace) -> range:
    """The seeds 1 to N of the option --seeds; ParameterError if there is none."""
    if given.seeds < 1:
        raise ParameterError(f"--seeds {given.seeds} is refused, allowed is 1 or more")
    return range(1, given.seeds + 1)


def case_name(method: int, driver: str, seed: int) -> str:
    """Name of a case without changes."""
    return f"method {method} {driver} seed {seed}"


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """Efficiencies [1] and energies [J] over the traction windows of a cycle, means of the driven wheels.

    What cannot be measured, because a short run has no traction, is left out.
    """
    vehicle = run.configurations[MASTER].common.vehicle
    driver = run.configurations["driver"].values()
    try:
        sums = wheel_sums(recording, vehicle, driver).values()
        shaft, battery = energies(recording, driver)
        wheel = sum(wheel.efficiency for wheel in sums) / len(sums)
        speed = sum(wheel.speed_efficiency for wheel in sums) / len(sums)
    except NotMeasured:
        return {}
    if battery <= 0.0:
        return {}
    return {
        "wheel_efficiency": wheel,
        "wheel_speed_efficiency": speed,
        "drive_efficiency": shaft / battery,
        "energy": battery,
        "slip_energy": slip_energy(recording, vehicle, driver),
        "distance": float(recording.channels["pose.x"][-1]),
    }
