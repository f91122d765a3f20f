"""The runs that Tatar & Chudzik are judged on, and forces from them in the axes of the car (eq 4)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ev_msgs_py.vehicle.description import Vehicle
from ev_sim.report.quantities.car_axes import tyre_force
from ev_sim.report.quantities.passing_speed import when_passing
from ev_sim.report.samples import run_named
from ev_sim.running.recording.recording import Recording
from ev_sim.verdicts.check import Measure
from ev_sim.verdicts.need import ScenarioNeed, ScenarioRuns

RUNS = ScenarioNeed("tatar_chudzik")
LAYOUTS = ("front", "rear", "all")
CONTROLS = EQUAL, CORRECTED = ("equal", "corrected")
SPEEDS = (7.6, 8.0, 8.5, 9.0)  # [m/s], which every run passes in the bend
WHEELS = {"FL": "front_left", "FR": "front_right", "RL": "rear_left", "RR": "rear_right"}
ASSUMPTION = "tyre, drive torque, gain of the correction and more torque for the outer wheel, none of which is given"

Values = Callable[[Recording, Vehicle], np.ndarray]


def passing(run: str, speed: float, values: Values) -> Measure:
    """A quantity (n,) of a run when it passes a speed [m/s] in the bend."""

    def measure(driven: ScenarioRuns) -> float:
        recording = run_named(driven.runs, run)
        return when_passing(recording, speed, values(recording, driven.vehicle))

    return measure


def force_y(wheel: str) -> Values:
    """F_y of a wheel in the axes of the car [N]."""
    return lambda run, vehicle: tyre_force(run, wheel, vehicle).y
