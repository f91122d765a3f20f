"""Cycle and traction control of the dissertation (chapter 2): table 2.4, eqs 2.36 to 2.40.

Each public function measures one number of published.csv, on the run of the cycle.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np

from ev_core.parameters.data_file import find_file
from ev_core.vehicle.driveline import wheel_inertia
from ev_core.vehicle.losses import loss_power
from ev_papers.dissertation.measures.circuits import CircuitSums, circuits
from ev_papers.dissertation.measures.slip_curve import (
    LARGEST_ERROR,
    SlipCurve,
    first_passed_peak,
    slip_and_road_torque,
)
from ev_papers.dissertation.measures.traction_windows import traction
from ev_stack.measures.metric import channel, run_named
from ev_stack.recording.recording import Recording
from ev_study.verdicts.need import ScenarioRuns

_KILOMETRE_PER_HOUR = 1 / 3.6  # [m/s]
_CYCLE_TIME = 580.0  # [s]
_LEFT = "front_left"
_FREE = "rear_left"
# What the report has of each of them.
_REPORTED: Mapping[str, Callable[[CircuitSums], float]] = {
    "wheel": lambda circuit: circuit.efficiency,
    "drive": lambda circuit: circuit.drive_efficiency,
    "total": lambda circuit: circuit.total_efficiency,
    "energy": lambda circuit: circuit.energy(_CYCLE_TIME),
}


def _model(driven: ScenarioRuns) -> Recording:
    return run_named(driven.runs, "urban_mixed")


def _points(driven: ScenarioRuns) -> np.ndarray:
    """Time [s] and speed [m/s] of the driver's profile, (n, 2)."""
    driver = driven.parameters["driver"]
    return np.column_stack((driver["speed_profile.time"], driver["speed_profile.speed"]))


def points(driven: ScenarioRuns) -> float:
    """Number of points of the driver's profile."""
    return float(len(_points(driven)))


def beyond_the_table(driven: ScenarioRuns) -> float:
    """Largest difference of the profile from table 2.4 at the points of both [m/s]."""
    table = np.loadtxt(find_file("cycles/trrl_1_1.csv"), delimiter=",", skiprows=1)
    points = _points(driven)
    times = np.union1d(points[:, 0], table[:, 0])
    printed = np.interp(times, table[:, 0], table[:, 1] * _KILOMETRE_PER_HOUR)
    ours = np.interp(times, points[:, 0], points[:, 1])
    return float(np.abs(ours - printed).max())


def length(driven: ScenarioRuns) -> float:
    """Length of the driver's profile [m]."""
    points = _points(driven)
    mean_speeds = (points[1:, 1] + points[:-1, 1]) / 2
    return float((np.diff(points[:, 0]) * mean_speeds).sum())


def duration(driven: ScenarioRuns) -> float:
    """Duration of the driver's profile [s]."""
    return float(_points(driven)[-1, 0])


def mean_speed(driven: ScenarioRuns) -> float:
    """Mean speed of the driver's profile [km/h]."""
    return length(driven) / duration(driven) / _KILOMETRE_PER_HOUR


def windows(driven: ScenarioRuns) -> float:
    """Number of windows that the driver is given."""
    return float(len(driven.parameters["driver"]["modes.begin"]))


def time_of(driven: ScenarioRuns, mode: str) -> float:
    """Time of all windows of a mode [s]."""
    driver = driven.parameters["driver"]
    lengths = np.diff([*driver["modes.begin"], _CYCLE_TIME])
    is_of_mode = [each == mode for each in driver["modes.mode"]]
    return float(lengths[is_of_mode].sum())


class _Samples:
    """Quantities of the left circuit that the equations sum, of the samples in traction, (n,)."""

    def __init__(self, driven: ScenarioRuns) -> None:
        run, car = _model(driven), driven.vehicle
        inside = traction(run, driven.parameters["driver"])

        def of(name: str) -> np.ndarray:
            return channel(run, name)[inside]

        speed = channel(run, f"wheel_states.velocity.{_LEFT}")
        # The first sample has no period before it, and is in no window.
        period = np.diff(run.time, prepend=run.time[0] - 1.0)
        acceleration = (np.diff(speed, prepend=speed[0]) / period)[inside]
        gained = wheel_inertia(car, _LEFT) * acceleration
        force = of(f"tire_forces.longitudinal_force.{_LEFT}")
        self.torque = of(f"wheel_states.effort.{_LEFT}")  # M_k [N m]
        self.resistance = self.torque - car.wheel_radius * force - gained  # M_f [N m]
        self.speed = speed[inside]  # w_k [rad/s]
        self.free = of(f"wheel_states.velocity.{_FREE}")  # w_free [rad/s]
        motor = of(f"motor_states.effort.{_LEFT}")
        shaft = of(f"motor_states.velocity.{_LEFT}")
        self.mechanical = motor * shaft  # [W]
        self.electrical = self.mechanical + loss_power(car.motor, motor, shaft)  # U I [W]
        self.reported = circuits(run, car, inside)[_LEFT]

    def wheel(self) -> float:
        """Eq 2.37 [1]."""
        force = (self.torque.sum() - self.resistance.sum()) / self.torque.sum()
        return float(force * self.free.sum() / self.speed.sum())

    def drive(self) -> float:
        """Eq 2.38 [1]."""
        return float(self.mechanical.sum() / self.electrical.sum())

    def total(self) -> float:
        """Eq 2.39 [1]."""
        return self.wheel() * self.drive()

    def energy(self) -> float:
        """Eq 2.40 of one circuit [W s]."""
        return float(self.electrical.sum() * _CYCLE_TIME / len(self.electrical))


def beyond_the_formula(driven: ScenarioRuns, name: str) -> float:
    """Difference of the reported efficiency or energy from eqs 2.37 to 2.40 as printed [1]."""
    samples = _Samples(driven)
    printed = getattr(samples, name)()
    return _REPORTED[name](samples.reported) / printed - 1.0


def largest_error() -> float:
    """Largest F of a fit that counts [1]."""
    return LARGEST_ERROR


def _fit(driven: ScenarioRuns) -> SlipCurve:
    """Fit where the left wheel first passes its peak."""
    return first_passed_peak(_model(driven), driven.vehicle, _LEFT)


def beyond_the_zero_of_the_slope(driven: ScenarioRuns) -> float:
    """Distance of (B/(2 A))^2 from where A + B/(2 sqrt(x)) changes its sign, by halving [1]."""
    curve = _fit(driven)
    if not curve.a < 0.0 < curve.b:
        return math.inf
    low, high = 1e-12, 1.0
    # More halvings than a double has bits: what is left is rounding.
    for _ in range(200):
        middle = (low + high) / 2
        slope = curve.a + curve.b / (2 * math.sqrt(middle))
        if slope > 0.0:
            low = middle
        else:
            high = middle
    return abs(curve.peak - low)


def rises_then_falls(driven: ScenarioRuns) -> bool:
    """True if the fitted curve rises to its peak, and samples lie beyond it, where it falls."""
    curve = _fit(driven)
    slips, _ = slip_and_road_torque(_model(driven), driven.vehicle, _LEFT)
    first, *_, last = slips[curve.window]
    has_both_sides = first < curve.peak < last
    return bool(has_both_sides and curve.at(first) < curve.at(curve.peak) > curve.at(last))
