"""Course stability for Shchur's car on packed snow beside power steering alone: lane change, push by hand, robot."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ev_msgs_py.contract.roles import MASTER
from ev_sim.measures import handling, motion
from ev_sim.measures.metric import Metric, channel
from ev_sim.recording.recording import Recording
from ev_sim.scenarios.scenario import Run
from ev_study.studies.study import Case, Results, metrics_of_cases, rows_of_cases

ABOUT = "Shchur 2019, further work: power steering and a yaw moment share the front difference on packed snow"
SCENARIO = "course_stability"
UNITS = {"peak_hand_torque": "N m", "hand_torque": "N m", "yaw_rate_error": "rad/s", "peak_sideslip": "rad"}
UNITS |= {"peak_angle": "rad", "peak_difference": "N m"}  # of the road wheels; of the torque requests, right minus left
COLUMNS = ("manoeuvre", "control", *(f"{name} [{unit}]" for name, unit in UNITS.items()))
LEFT = 2

_LAW, _HANDS = "electronic_differential", "driver"
_NONE = ((_LAW, "method", "equal_torque"),)
_FIRM = tuple((_HANDS, f"hands.angle_control.{k}_gain", v) for k, v in {"proportional": 3.0, "integral": 6.0}.items())
_FIRM += ((_HANDS, "hands.angle_control.derivative_gain", 0.3),)  # those of double_lane_change
_CONTROLS: dict[str, tuple] = {
    "no power steering": _NONE,
    "power steering": ((_LAW, "method", "power_steering"),),
    "steering first": (),
    "yaw first": ((_LAW, "first", "yaw"),),
    "friction believed twice": ((_LAW, "error_factor", 2.0),),
    "wish by the angle": ((_LAW, "wish", "angle"),),
    "against both": ((_LAW, "against", "both"),),
    "gain 1000": ((_LAW, "yaw_gain", 1000.0),),
    "wish by the angle, gain 1000": ((_LAW, "wish", "angle"), (_LAW, "yaw_gain", 1000.0)),
    "against both, gain 1000": ((_LAW, "against", "both"), (_LAW, "yaw_gain", 1000.0)),
}
# A geometry that gives the drives no lever arm, and hands that are not assisted.
_NO_LEVER = (
    ("steering_column", "method", "manual"),
    (_LAW, "gamma", 0.0),
    (_LAW, "k_ck", 0.0),
    (_LAW, "b_ck", 0.0),
    *_FIRM,
)
_STRONG = ((_LAW, "against", "both"), (_LAW, "yaw_gain", 5000.0), (_LAW, "largest_hand_torque", 100.0))
_BESIDE = {"no yaw moment": _NONE, "yaw moment": (), "against both, gain 5000, 1600 N m": _STRONG}
_ROBOT: dict[str, tuple] = {
    "no yaw moment": _NONE,
    "against both, gain 5000, 48 N m": ((_LAW, "wish", "angle"), *_STRONG[:2]),
    "against both, gain 5000, 1600 N m": ((_LAW, "wish", "angle"), *_STRONG),
}


def _manoeuvres() -> dict[str, tuple[dict[str, tuple], tuple, float]]:
    """By name: controls, what differs from the scenario, duration [s]."""

    def at(kmh: float) -> tuple:
        return (("plant", "initial_speed", kmh / 3.6), (_HANDS, "speed_profile.speed", (kmh / 3.6,)))

    pushed = (
        (_HANDS, "method", "speed_profile"),
        (_HANDS, "steering.mode", "hand_torque"),
        (_HANDS, "steering.hand_torque.time", (0.0, 1.0)),
        (_HANDS, "steering.hand_torque.torque", (0.0, 0.06)),  # N m: 4.2 deg, beyond what the snow holds
    )
    held = (
        (_HANDS, "method", "manoeuvre"),
        ("steering_column", "method", "steering_robot"),
        ("steering_column", "profile.time", (1.0, 1.1)),
        ("steering_column", "profile.angle", (0.0, 1.5)),
    )
    lanes = {f"lane change, {kmh} km/h": (_CONTROLS, at(kmh), 9.0) for kmh in (80, 90, 100)}
    pushes = {name: values for name, values in _CONTROLS.items() if values is not _NONE}
    scarce = (("plant", "road.left", ("packed_snow_2",)), ("plant", "road.right", ("packed_snow_2",)))
    beside = ("power steering", "steering first", "yaw first", "friction believed twice")
    return lanes | {
        "lane change, snow 2, 50 km/h": ({name: _CONTROLS[name] for name in beside}, at(50) + scarce, 11.0),
        "lane change, 90 km/h, no lever": (_BESIDE, at(90) + _NO_LEVER, 9.0),
        "0.06 N m by hand, 80 km/h": (pushes, at(80) + pushed, 6.0),
        "robot holds 5.4 deg, 80 km/h": (_ROBOT, at(80) + held, 6.0),
    }


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Every control in every manoeuvre of the page docs/shchur2019.md.

    Hands without power steering are those of double_lane_change.
    """
    return [
        Case(f"{manoeuvre}: {control}", SCENARIO, common + values + firm, "course_stability", duration=duration)
        for manoeuvre, (controls, common, duration) in _manoeuvres().items()
        for control, values in controls.items()
        for firm in [_FIRM if values is _NONE and controls is _CONTROLS else ()]
    ]


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """UNITS: largest and root mean square hand torque, errors of yaw rate and course, road-wheel angle, difference."""
    hands = channel(recording, "steering_column.state.hand_torque")
    sides = (channel(recording, f"torque_request.drive.front_{side}") for side in ("right", "left"))
    return {
        "peak_hand_torque": float(np.abs(hands).max()),
        "hand_torque": float(np.sqrt(np.mean(hands**2))),
        "yaw_rate_error": handling.yaw_rate_error(recording, run.configurations[MASTER].common.vehicle),
        "peak_sideslip": handling.peak_sideslip(recording),
        "peak_angle": float(np.abs(channel(recording, motion.ROAD_WHEEL_ANGLE)).max()),
        "peak_difference": float(np.abs(np.subtract(*sides)).max()),
    }


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """Each quantity of each case."""
    return metrics_of_cases(results, UNITS)


def rows(given: argparse.Namespace, results: Results) -> Sequence[tuple[str, ...]]:
    """One row for each case."""
    return rows_of_cases(results, dict.fromkeys(UNITS, ".3g"))
