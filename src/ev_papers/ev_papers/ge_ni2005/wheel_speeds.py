"""Wheel-speed control beside the slip targets of Ge & Ni (2005): their arguments against it.

Every control drives the source's turn and straight run, with a wheel that is smaller, with more
torque than the road takes, on a slippery road, and with ice under the left wheels.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ev_papers.ge_ni2005.quantities import chatter, slip, yaw_rate
from ev_stack.measures.metric import Metric, channel
from ev_stack.recording.recording import Recording
from ev_stack.scenarios.records import Run
from ev_study.studies.study import Case, Results, metrics_of_cases, rows_of_cases

ABOUT = (
    "Ge & Ni 2005: wheel speeds after Ackermann beside slip targets and equal torques "
    "- turn, wheel radius, road"
)
SCENARIO = "ge_ni2005"
UNITS = {
    "yaw_rate": "rad/s",
    "aside": "m",
    "slip_left": "1",
    "slip_right": "1",
    "peak_slip": "1",
    "chatter": "N m/s",
}
COLUMNS = ("run", "control", *(f"{name} [{unit}]" for name, unit in UNITS.items()))
LEFT = 2

Values = tuple[tuple[str, str, Any], ...]
_LAW = "electronic_differential"
_BY_SPEEDS = (_LAW, "method", "wheel_speed")
_CONTROLS: Mapping[str, Values] = {
    "equal torques": ((_LAW, "method", "equal_torque"),),
    "speed difference": (_BY_SPEEDS,),
    "both speeds": (_BY_SPEEDS, (_LAW, "mean", "speed")),
    "slip, rate": ((_LAW, "reading", "rate"),),
    "slip, offset": ((_LAW, "reading", "offset"),),
    "slip, increment": ((_LAW, "reading", "increment"),),
}
_STRAIGHT: Values = (("steering_column", "profile.angle", (0.0,)),)
_LEFT_SMALLER: Values = (("*", "vehicle.wheel_radius_ratio", (1.0, 1.0, 0.99, 1.0)),)
_SLIPPERY: Values = (
    ("*", "vehicle.tyre.coefficients", (0.4, 0.1, 0.0, 0.0)),  # half the friction at half the slip
    ("plant", "initial_drive_torque", (0.0, 0.0, 600.0, 600.0)),
)
_SPLIT: Values = (
    ("*", "vehicle.tyre.curve", "burckhardt"),  # its friction is the surface's
    ("plant", "road.left", ("ice",)),
    ("plant", "initial_drive_torque", (0.0, 0.0, 50.0, 50.0)),
)


_FREE = "rate_free_speed"
_FULL_FREE = "rate_full_car_free_speed"


def _pedal(torque: float) -> Values:
    """A torque for each rear wheel [N m]."""
    return (("driver", "pedals.drive_torque", (2.0 * torque,)),)


# By name the run of the scenario, and what differs from it.
_RUNS: Mapping[str, tuple[str, Values]] = {
    "turn": ("rate", ()),
    "turn, u free": (_FREE, ()),
    "turn, full car, u free": (_FULL_FREE, ()),
    "turn, left wheel 1 % smaller": ("rate", _LEFT_SMALLER),
    "straight, left wheel 1 % smaller": ("rate", _STRAIGHT + _LEFT_SMALLER),
    "turn, 1600 N m on each wheel": ("rate", _pedal(1600.0)),
    "turn, 1700 N m on each wheel": ("rate", _pedal(1700.0)),
    "turn, slippery, 600 N m on each wheel": ("rate", _SLIPPERY + _pedal(600.0)),
    "turn, slippery, 900 N m on each wheel": ("rate", _SLIPPERY + _pedal(900.0)),
    "straight, ice left, full car, u free": (_FULL_FREE, _STRAIGHT + _SPLIT + _pedal(1000.0)),
}


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Every control in every run, as on the page docs/ge_ni2005.md."""
    found = []
    for name, (run, changed) in _RUNS.items():
        for control, values in _CONTROLS.items():
            found.append(Case(f"{name}: {control}", SCENARIO, (*changed, *values), run))
    return found


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """Quantities of UNITS: those of motion and slip in the end, the largest slip, the chatter."""
    left = slip(recording, "left")
    right = slip(recording, "right")
    return {
        "yaw_rate": yaw_rate(recording),
        "aside": float(channel(recording, "pose.y")[-1]),
        "slip_left": float(left[-1]),
        "slip_right": float(right[-1]),
        "peak_slip": float(np.abs([left, right]).max()),
        "chatter": chatter(recording),
    }


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """Each quantity of each case."""
    return metrics_of_cases(results, UNITS)


def rows(given: argparse.Namespace, results: Results) -> Sequence[tuple[str, ...]]:
    """One row for each case."""
    return rows_of_cases(results, dict.fromkeys(UNITS, ".3g"))
