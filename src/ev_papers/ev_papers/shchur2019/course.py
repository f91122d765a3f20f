"""Course stability beside power steering for Shchur's car on packed snow.

A law for both gives the front drives one torque difference, of which assistance and yaw moment want
a part each. The cases set a lane change, a push by hand and an angle that a robot holds against it.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ev_msgs_py.contract.roles import MASTER
from ev_stack.measures import handling, motion
from ev_stack.measures.metric import Metric, channel
from ev_stack.recording.recording import Recording
from ev_stack.scenarios.records import Run
from ev_study.studies.study import Case, Results, metrics_of_cases, rows_of_cases

ABOUT = (
    "Shchur 2019, further work: power steering and a yaw moment share the front difference "
    "on packed snow"
)
SCENARIO = "course_stability"
UNITS = {
    "peak_hand_torque": "N m",
    "hand_torque": "N m",
    "yaw_rate_error": "rad/s",
    "peak_sideslip": "rad",
    "peak_angle": "rad",  # of the road wheels
    "peak_difference": "N m",  # of the torque requests, right minus left
}
COLUMNS = ("manoeuvre", "control", *(f"{name} [{unit}]" for name, unit in UNITS.items()))
LEFT = 2

Values = tuple[tuple[str, str, Any], ...]
_LAW = "electronic_differential"
_HANDS = "driver"
_NO_ASSISTANCE: Values = ((_LAW, "method", "equal_torque"),)
# Hands without assistance push harder: these gains are those of double_lane_change.
_FIRM_HANDS: Values = (
    (_HANDS, "hands.angle_control.proportional_gain", 3.0),
    (_HANDS, "hands.angle_control.integral_gain", 6.0),
    (_HANDS, "hands.angle_control.derivative_gain", 0.3),
)
_BY_ANGLE = (_LAW, "wish", "angle")
_AGAINST_BOTH = (_LAW, "against", "both")
_CONTROLS: Mapping[str, Values] = {
    "no power steering": _NO_ASSISTANCE,
    "power steering": ((_LAW, "method", "power_steering"),),
    "steering first": (),
    "yaw first": ((_LAW, "first", "yaw"),),
    "friction believed twice": ((_LAW, "error_factor", 2.0),),
    "wish by the angle": (_BY_ANGLE,),
    "against both": (_AGAINST_BOTH,),
    "gain 1000": ((_LAW, "yaw_gain", 1000.0),),
    "wish by the angle, gain 1000": (_BY_ANGLE, (_LAW, "yaw_gain", 1000.0)),
    "against both, gain 1000": (_AGAINST_BOTH, (_LAW, "yaw_gain", 1000.0)),
}
_ON_LITTLE_GRIP = ("power steering", "steering first", "yaw first", "friction believed twice")
# A geometry that gives the drives no lever arm, and hands that are not assisted.
_NO_LEVER: Values = (
    ("steering_column", "method", "manual"),
    (_LAW, "gamma", 0.0),
    (_LAW, "k_ck", 0.0),
    (_LAW, "b_ck", 0.0),
    *_FIRM_HANDS,
)
_STRONG_YAW = (_AGAINST_BOTH, (_LAW, "yaw_gain", 5000.0))
_UNLIMITED = (_LAW, "largest_hand_torque", 100.0)
_WITHOUT_LEVER: Mapping[str, Values] = {
    "no yaw moment": _NO_ASSISTANCE,
    "yaw moment": (),
    "against both, gain 5000, 1600 N m": (*_STRONG_YAW, _UNLIMITED),
}
_WITH_ROBOT: Mapping[str, Values] = {
    "no yaw moment": _NO_ASSISTANCE,
    "against both, gain 5000, 48 N m": (_BY_ANGLE, *_STRONG_YAW),
    "against both, gain 5000, 1600 N m": (_BY_ANGLE, *_STRONG_YAW, _UNLIMITED),
}
_SCARCE_GRIP: Values = (
    ("plant", "road.left", ("packed_snow_2",)),
    ("plant", "road.right", ("packed_snow_2",)),
)
_PUSHED_BY_HAND: Values = (
    (_HANDS, "method", "speed_profile"),
    (_HANDS, "steering.mode", "hand_torque"),
    (_HANDS, "steering.hand_torque.time", (0.0, 1.0)),
    # 0.06 N m turn the wheels by 4.2 deg, beyond what the snow holds.
    (_HANDS, "steering.hand_torque.torque", (0.0, 0.06)),
)
_HELD_BY_ROBOT: Values = (
    (_HANDS, "method", "manoeuvre"),
    ("steering_column", "method", "steering_robot"),
    ("steering_column", "profile.time", (1.0, 1.1)),
    ("steering_column", "profile.angle", (0.0, 1.5)),
)


@dataclass(frozen=True, slots=True)
class Manoeuvre:
    """Controls that are driven, what differs from the scenario's file, and for how long [s]."""

    controls: Mapping[str, Values]
    values: Values
    duration: float


def _at(kmh: float) -> Values:
    """Start and driver's set-point at a speed [km/h]."""
    speed = kmh / 3.6
    return (("plant", "initial_speed", speed), (_HANDS, "speed_profile.speed", (speed,)))


def _manoeuvres() -> dict[str, Manoeuvre]:
    found = {
        f"lane change, {kmh} km/h": Manoeuvre(_CONTROLS, _at(kmh), 9.0) for kmh in (80, 90, 100)
    }
    scarce = {name: _CONTROLS[name] for name in _ON_LITTLE_GRIP}
    assisted = {name: values for name, values in _CONTROLS.items() if values is not _NO_ASSISTANCE}
    return found | {
        "lane change, snow 2, 50 km/h": Manoeuvre(scarce, _at(50) + _SCARCE_GRIP, 11.0),
        "lane change, 90 km/h, no lever": Manoeuvre(_WITHOUT_LEVER, _at(90) + _NO_LEVER, 9.0),
        "0.06 N m by hand, 80 km/h": Manoeuvre(assisted, _at(80) + _PUSHED_BY_HAND, 6.0),
        "robot holds 5.4 deg, 80 km/h": Manoeuvre(_WITH_ROBOT, _at(80) + _HELD_BY_ROBOT, 6.0),
    }


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Every control in every manoeuvre of the page docs/shchur2019.md."""
    found = []
    for manoeuvre, of in _manoeuvres().items():
        for control, values in of.controls.items():
            if control == "no power steering":
                values = values + _FIRM_HANDS
            name = f"{manoeuvre}: {control}"
            changed = of.values + values
            found.append(Case(name, SCENARIO, changed, "course_stability", duration=of.duration))
    return found


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """Largest and root mean square values of the quantities of UNITS."""
    vehicle = run.configurations[MASTER].common.vehicle
    hands = channel(recording, motion.HAND_TORQUE)
    difference = motion.differential_torque(recording)
    return {
        "peak_hand_torque": float(np.abs(hands).max()),
        "hand_torque": float(np.sqrt(np.mean(hands**2))),
        "yaw_rate_error": handling.yaw_rate_error(recording, vehicle),
        "peak_sideslip": handling.peak_sideslip(recording),
        "peak_angle": float(np.abs(channel(recording, motion.ROAD_WHEEL_ANGLE)).max()),
        "peak_difference": float(np.abs(difference).max()),
    }


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """Each quantity of each case."""
    return metrics_of_cases(results, UNITS)


def rows(given: argparse.Namespace, results: Results) -> Sequence[tuple[str, ...]]:
    """One row for each case."""
    return rows_of_cases(results, dict.fromkeys(UNITS, ".3g"))
