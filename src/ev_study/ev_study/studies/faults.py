"""Every electronic differential with every fault in mid-turn, on a dry and a wet road, with and without a limp mode.

How it works: every law drives the same turn, and at BEGIN one fault begins. What counts are the
largest deviations from then on. A case is safe if the car stays in its lane and does not slide.
Where a motor is struck, each law also drives with the limp mode of the traction control.
"""

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
from ev_study.studies.options import add_choice
from ev_study.studies.study import Case, Results, own_methods

BEGIN = 5.0  # of the fault [s]
DURATION = 10.0  # [s]
SCENARIO = "double_lane_change"
ABOUT = (
    "Every electronic differential with every fault in mid-turn, on dry and wet roads: "
    "path, yaw rate, sideslip, safe?"
)
ROADS = {"dry": "dry_asphalt", "wet": "wet_asphalt_1"}
ROLE = "electronic_differential"
DRAWN = "power_steering"
OFF = "off"
LIMP = "limp_home"
_ON_A_ROAD = ("path error [m]", "yaw rate error [deg/s]", "sideslip [deg]", "safe")
COLUMNS = ("fault", "law", "asr", *(f"{road}: {what}" for road in ROADS for what in _ON_A_ROAD))
LEFT = 3
SUMS = ("safe_",)
SHORTEST = BEGIN
CURVES = {"deviation": "m", "yaw_rate": "deg/s"}  # over time, with their units
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
    column = "manual" if law == name else "powered"
    # Their column has no shaft between hands and wheels.
    if law in BY_WIRE:
        column = "by_wire"
    values = [
        *TURN,
        ("plant", "road.left", [ROADS[road]]),
        ("plant", "road.right", [ROADS[road]]),
        (ROLE, "method", name),
        ("asr", "method", asr),
        ("steering_column", "method", column),
    ]
    if asr == LIMP:
        values.append(("asr", "plausibility.keep_difference", column != "manual"))
    until = f" until {_ENDS[fault]:g}" if fault in _ENDS else ""
    for role, of in FAULTS[fault].items():
        values.append((role, "faults", [f"{each} from {BEGIN:g}{until}" for each in of]))
    return tuple(values)


def laws() -> list[str]:
    """All electronic differentials of the package that brings the node.

    Two of them are listed with another column as well.
    """
    return [*own_methods(ROLE), f"equal_torque{POWERED}", DRAWN + POWERED]


def add_options(parser: argparse.ArgumentParser) -> None:
    """A part of the laws and faults instead of all, and what counts as safe."""
    add_choice(parser, "--laws", laws(), "LAW")
    add_choice(parser, "--faults", FAULTS, "FAULT")
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
    """Fault, law and traction control of all cases."""
    for fault in given.faults or FAULTS:
        controls = (OFF, LIMP) if fault in (SOUND, *OF_MOTORS) else (OFF,)
        for law in given.laws or laws():
            for asr in controls:
                yield fault, law, asr


def name_of(fault: str, law: str, asr: str, road: str) -> str:
    """Name of a case."""
    return f"{fault}: {law}, {asr}, {road}"


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Every law with every fault, and with a limp mode where motors are struck.

    What the car forbids is refused.
    """
    found = []
    for of_case in _combinations(given):
        fault, law, asr = of_case
        for road in ROADS:
            values = values_of(road, law, asr, fault)
            found.append(Case(name_of(*of_case, road), SCENARIO, values, duration=DURATION))
    return found


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """Largest deviations from the fault on.

    They are those from the path [m] and from its yaw rate [deg/s], and the sideslip angle [deg].
    """
    wanted = run.configurations["driver"].parameters.path
    path = path_of(wanted)
    after = recording.time >= BEGIN
    deviation = np.zeros(len(recording.time))
    leg = 0
    places = zip(channel(recording, "pose.x"), channel(recording, "pose.y"), strict=True)
    for n, (x, y) in enumerate(places):
        _, leg = nearest(path, x, y, leg)
        # Cross product of direction and distance: positive to the left of the path.
        across = path.along_x[leg] * (y - path.y[leg])
        deviation[n] = across - path.along_y[leg] * (x - path.x[leg])
    speed = channel(recording, "twist.longitudinal")
    # The circle is the last leg of the path; the fault comes when the car is on it.
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
    # What is left on each side of a car in the middle of the lane.
    half = 0.5 * (given.lane - given.car_width)
    return bool(measured["path_error"] <= half and measured["sideslip"] <= given.sideslip)


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """Numbers of faults, dry and wet, with which each law is safe without the limp mode."""
    found: dict[str, Metric] = {}
    faults = [fault for fault in given.faults or FAULTS if fault != SOUND]
    for law in given.laws or laws():
        safe = []
        for fault, road in itertools.product(faults, ROADS):
            measured = results[name_of(fault, law, OFF, road)].measured
            if measured:
                safe.append(is_safe(given, measured))
        # A law that the car forbids has no row.
        if safe:
            found[f"safe_{law}"] = Metric(float(sum(safe)), "1")
    return found


def rows(given: argparse.Namespace, results: Results) -> list[tuple[str, ...]]:
    """Fault, law and traction control, and what was measured on each road.

    Laws that the car forbids are left out.
    """
    found = []
    for of_case in _combinations(given):
        measured = [results[name_of(*of_case, road)].measured for road in ROADS]
        if any(measured):
            row = [*of_case]
            for of_road in measured:
                row += _cells(given, of_road)
            found.append(tuple(row))
    return found


def _cells(given: argparse.Namespace, measured: Mapping[str, Any]) -> tuple[str, ...]:
    """Cells of a road below _ON_A_ROAD."""
    if not measured:
        return ("–",) * len(_ON_A_ROAD)
    return (
        f"{measured['path_error']:.2f}",
        f"{measured['yaw_rate_error']:.1f}",
        f"{measured['sideslip']:.1f}",
        "yes" if is_safe(given, measured) else "no",
    )


def figures(given: argparse.Namespace, results: Results) -> dict[str, Sheet]:
    """Deviation from the path and yaw rate error over time: power steering with a dead motor."""
    shown = (
        ("deviation", "deviation from the path, left positive", "deviation [m]"),
        ("yaw_rate", "yaw rate less that of the path", "yaw rate [deg/s]"),
    )
    pairs = [(SOUND, OFF), *itertools.product(OF_MOTORS[:2], (OFF, LIMP))]
    panels = []
    for law, road in itertools.product((DRAWN, DRAWN + POWERED), ROADS):
        for quantity, title, ylabel in shown:
            curves = []
            for fault, asr in pairs:
                result = results.get(name_of(fault, law, asr, road))
                if result is not None and "time" in result.measured:
                    values = result.measured[quantity]
                    label = f"{fault}, {readable(asr)}"
                    curves.append(Curve(result.measured["time"], values, label))
            panels.append(Panel(f"{readable(law)}, {road}: {title}", ylabel, curves))
    return {DRAWN: Sheet(panels)}
