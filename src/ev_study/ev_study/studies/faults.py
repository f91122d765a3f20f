"""Every electronic differential with every fault in mid-turn, on a dry and a wet road, with and without a limp mode."""

from __future__ import annotations

import argparse
import itertools
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from ev_sim.driver.path import nearest, path_of
from ev_stack.command_line.numbers import real
from ev_stack.figures.panels import Curve, Panel, readable
from ev_stack.figures.sheets import Sheet
from ev_stack.measures import motion
from ev_stack.measures.metric import Metric, channel
from ev_stack.recording.recording import Recording
from ev_stack.scenarios.records import Run
from ev_study.studies.study import Case, Results, own_methods

BEGIN = 5.0  # of the fault [s]
DURATION = 10.0  # [s]
SCENARIO = "double_lane_change"
ROADS = {"dry": "dry_asphalt", "wet": "wet_asphalt_1"}
BY_WIRE = ("drive_by_wire", "steer_by_wire")
# behind the name of a law: on the column of Shchur (2019), with half the track as its lever
POWERED = " (powered)"
SOUND = "none"

# 40 m straight on, then a circle of 100 m radius at 60 km/h; from 4 s on the driver goes up to 75
# km/h within 5 s. The gains of the hands are softer than those of other path followers, with which
# the assistance of the steering swings.
TURN: tuple[tuple[str, str, Any], ...] = (
    ("plant", "initial_x", 0.0),
    ("plant", "initial_speed", 60 / 3.6),
    ("driver", "speed_profile.time", [0.0, 4.0, 9.0]),
    ("driver", "speed_profile.speed", [60 / 3.6, 60 / 3.6, 75 / 3.6]),
    ("driver", "path.shape", "arcs"),
    ("driver", "path.length", [40.0, 600.0]),
    ("driver", "path.curvature", [0.0, 0.01]),
    ("driver", "hands.angle_control.proportional_gain", 0.5),
    ("driver", "hands.angle_control.integral_gain", 1.0),
    ("driver", "hands.angle_control.derivative_gain", 0.1),
)

_COLUMN = "steering_column/state"
_LAW = "torque_request"
FAULTS: dict[str, dict[str, list[str]]] = {  # what is wrong -> by role
    SOUND: {},
    "inner motor dead": {"plant": ["motor_share front_left 0"]},
    "outer motor dead": {"plant": ["motor_share front_right 0"]},
    "inner motor at half": {"plant": ["motor_share front_left 0.5"]},
    "outer motor stuck": {"plant": ["motor_stuck front_right"]},
    "inverters 0.1 s late": {"plant": ["inverter_delay front 0.1"]},
    "battery cut off": {"plant": ["battery_share battery 0"]},
    "outer front tyre flat": {"plant": ["puncture front_right 1"]},
    "outer rear tyre flat": {"plant": ["puncture rear_right 1"]},
    "inner wheel speed reads 0": {"plant": ["constant wheel_states.velocity.front_left 0"]},
    "front wheel speeds swapped": {
        "plant": ["swapped wheel_states.velocity.front_left,wheel_states.velocity.front_right"]
    },
    "accelerometer tilted by 0.1": {"plant": ["tilted imu.longitudinal_acceleration 0.1"]},
    "steering angle 0.2 rad off": {"steering_column": [f"offset {_COLUMN}.angle 0.2"]},
    "hand torque sensor lost": {"steering_column": [f"constant {_COLUMN}.hand_torque 0"]},
    "every third message lost": {
        "steering_column": [f"lost {_COLUMN} 0.333"],
        "plant": ["lost wheel_states 0.333"],
    },
    "law restarted for 0.5 s": {"electronic_differential": [f"restarted {_LAW}"]},
}
OF_MOTORS = ("inner motor dead", "outer motor dead", "inner motor at half", "outer motor stuck")
_ENDS = {"law restarted for 0.5 s": BEGIN + 0.5}


def values_of(road: str, law: str, asr: str, fault: str) -> tuple[tuple[str, str, Any], ...]:
    """Values of one case that differ from the scenario's own file."""
    name = law.removesuffix(POWERED)
    column = "by_wire" if law in BY_WIRE else "manual" if law == name else "powered"
    until = f" until {_ENDS[fault]:g}" if fault in _ENDS else ""
    return (
        *TURN,
        ("plant", "road.left", [ROADS[road]]),
        ("plant", "road.right", [ROADS[road]]),
        ("electronic_differential", "method", name),
        ("asr", "method", asr),
        ("steering_column", "method", column),
        *(
            (("asr", "plausibility.keep_difference", column != "manual"),)
            if asr == "limp_home"
            else ()
        ),
        *(
            (role, "faults", [f"{each} from {BEGIN:g}{until}" for each in of])
            for role, of in FAULTS[fault].items()
        ),
    )


ABOUT = "Every electronic differential with every fault in mid-turn, on dry and wet roads: path, yaw rate, sideslip, safe?"
ROLE, DRAWN = "electronic_differential", "power_steering"
OFF, LIMP = "off", "limp_home"
_ON_A_ROAD = ("path error [m]", "yaw rate error [deg/s]", "sideslip [deg]", "safe")
COLUMNS = ("fault", "law", "asr", *(f"{road}: {what}" for road in ROADS for what in _ON_A_ROAD))
LEFT = 3
SUMS = ("safe_",)
SHORTEST = BEGIN
CURVES = {"deviation": "m", "yaw_rate": "deg/s"}  # over time, with their units


def laws() -> list[str]:
    """All electronic differentials of the package that brings the node; two of them on another column as well."""
    return [*own_methods(ROLE), *(name + POWERED for name in ("equal_torque", DRAWN))]


def add_options(parser: argparse.ArgumentParser) -> None:
    """A part of the laws and faults instead of all, and what counts as safe."""
    parser.add_argument(
        "--laws", nargs="+", choices=laws(), metavar="LAW", help="these only; default: all"
    )
    parser.add_argument(
        "--faults",
        nargs="+",
        choices=list(FAULTS),
        metavar="FAULT",
        help="these only; default: all",
    )
    parser.add_argument(
        "--lane", type=real(0.0), default=3.5, help="width of the lane [m]; default: %(default)s"
    )
    parser.add_argument(
        "--car-width", type=real(0.0), default=1.7, help="of the car [m]; default: %(default)s"
    )
    parser.add_argument(
        "--sideslip",
        type=real(0.0, 180.0),
        default=10.0,
        help="largest sideslip [deg]; default: %(default)s",
    )


def _combinations(given: argparse.Namespace) -> Iterator[tuple[str, str, str]]:
    for fault in given.faults or FAULTS:
        for law in given.laws or laws():
            for asr in (OFF, LIMP) if fault in (SOUND, *OF_MOTORS) else (OFF,):
                yield fault, law, asr


def name_of(fault: str, law: str, asr: str, road: str) -> str:
    """Name of a case."""
    return f"{fault}: {law}, {asr}, {road}"


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Every law with every fault, and with a limp mode where motors are struck; what the car forbids is refused."""
    return [
        Case(
            name_of(fault, law, asr, road),
            SCENARIO,
            values_of(road, law, asr, fault),
            duration=DURATION,
        )
        for fault, law, asr in _combinations(given)
        for road in ROADS
    ]


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """Largest deviations from the fault on: from the path [m], from its yaw rate [deg/s], sideslip angle [deg]."""
    wanted = run.configurations["driver"].parameters.path
    path, after = path_of(wanted), recording.time >= BEGIN
    deviation, leg = np.zeros(len(recording.time)), 0
    for n, (x, y) in enumerate(
        zip(channel(recording, "pose.x"), channel(recording, "pose.y"), strict=True)
    ):
        _, leg = nearest(path, x, y, leg)
        along_x, along_y = path.along_x[leg], path.along_y[leg]
        deviation[n] = along_x * (y - path.y[leg]) - along_y * (x - path.x[leg])
    speed = channel(recording, "twist.longitudinal")
    yaw_rate = np.degrees(channel(recording, motion.YAW_RATE) - wanted.curvature[-1] * speed)
    sideslip = np.degrees(np.where(motion.moving(recording), motion.sideslip_angle(recording), 0.0))
    return {
        "path_error": float(np.abs(deviation[after]).max()),
        "yaw_rate_error": float(np.abs(yaw_rate[after]).max()),
        "sideslip": float(np.abs(sideslip[after]).max()),
        "end_speed": float(speed[-1]),
        "time": recording.time,
        "deviation": deviation,
        "yaw_rate": yaw_rate,
    }


def is_safe(given: argparse.Namespace, measured: Mapping[str, Any]) -> bool:
    """Return True if the car keeps its lane, and its sideslip the limit, from the fault on."""
    half = 0.5 * (given.lane - given.car_width)
    return bool(measured["path_error"] <= half and measured["sideslip"] <= given.sideslip)


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """Numbers of faults, dry and wet, with which each law is safe without the limp mode."""
    found: dict[str, Metric] = {}
    for law in given.laws or laws():
        names = [
            name_of(f, law, OFF, road)
            for f in given.faults or FAULTS
            if f != SOUND
            for road in ROADS
        ]
        safe = [is_safe(given, results[name].measured) for name in names if results[name].measured]
        if safe:
            found[f"safe_{law}"] = Metric(float(sum(safe)), "1")
    return found


def rows(given: argparse.Namespace, results: Results) -> list[tuple[str, ...]]:
    """Fault, law and traction control, and what was measured on each road; without laws that the car forbids."""
    found = []
    for fault, law, asr in _combinations(given):
        measured = [results[name_of(fault, law, asr, road)].measured for road in ROADS]
        if any(measured):
            found.append(
                (
                    fault,
                    law,
                    asr,
                    *(cell for of_road in measured for cell in _cells(given, of_road)),
                )
            )
    return found


def _cells(given: argparse.Namespace, measured: Mapping[str, Any]) -> tuple[str, ...]:
    if not measured:
        return ("–",) * len(_ON_A_ROAD)
    numbers = (
        f"{measured[name]:.{n}f}"
        for name, n in (("path_error", 2), ("yaw_rate_error", 1), ("sideslip", 1))
    )
    return (*numbers, "yes" if is_safe(given, measured) else "no")


def figures(given: argparse.Namespace, results: Results) -> dict[str, Sheet]:
    """Deviation from the path, yaw rate error and hand torque over time: power steering with a dead motor."""
    shown = (
        ("deviation", "deviation from the path, left positive", "deviation [m]"),
        ("yaw_rate", "yaw rate less that of the path", "yaw rate [deg/s]"),
    )
    pairs = [(SOUND, OFF), *((fault, asr) for fault in OF_MOTORS[:2] for asr in (OFF, LIMP))]
    panels = []
    for law, road, (quantity, title, ylabel) in itertools.product(
        (DRAWN, DRAWN + POWERED), ROADS, shown
    ):
        drawn = {
            f"{fault}, {readable(asr)}": results.get(name_of(fault, law, asr, road))
            for fault, asr in pairs
        }
        curves = [
            Curve(result.measured["time"], result.measured[quantity], label)
            for label, result in drawn.items()
            if result is not None and "time" in result.measured
        ]
        panels.append(Panel(f"{readable(law)}, {road}: {title}", ylabel, curves))
    return {DRAWN: Sheet(panels)}
