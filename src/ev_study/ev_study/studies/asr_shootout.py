"""Every traction control on every road: pulling away, split friction, jumps of friction, a hill, a bend.

How it works: a case is a control on a road. All of them have the same noise and the same pedal;
slips and forces are the true ones of the plant, while the control reads its noisy sensors. In
torque mode the command of the control is what the wheel gets; in speed mode the drive makes the
torque itself (`_given`).
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from ev_core.elementary import hypot
from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.driveline import drive_train_numbers
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_sim.driver.path import nearest, path_of, point_at
from ev_stack.figures.panels import Curve, Panel, readable
from ev_stack.figures.sheets import Sheet
from ev_stack.measures.handling import slip_powers
from ev_stack.measures.metric import Metric, channel, metric
from ev_stack.measures.motion import crossing_time, distance_on_path, heading, speed
from ev_stack.recording.recording import Recording
from ev_stack.scenarios.records import Run
from ev_study.studies.options import add_choice
from ev_study.studies.study import Case, Results, own_methods, rows_of_cases

ABOUT = (
    "All traction controls pulling away on ice, snow, wet and dry roads, split friction, "
    "friction jumps, hill, bend"
)
SCENARIO = "launch_split_mu"
RUN = "steered"
DURATION = 8.0  # [s]
SHORTEST = 1.0  # [s]; the driver asks for torque from 0.5 s on
PERIOD = 0.005  # of control, with which the runs are driven [s]
NOISE = {"wheel_speed": 0.03, "wheel_torque": 0.5, "imu_acceleration": 0.05, "imu_yaw_rate": 0.002}
COMMON = (
    ("*", "control_period", PERIOD),
    *(("plant", f"sensors.{sensor}.noise", deviation) for sensor, deviation in NOISE.items()),
)
TRACED = ("snow", "wet", "snow, then dry", "dry, then ice")
DRAWN = ("off", "least_squares", "slip_window", "pi_slip")

QUANTITIES = {  # what is measured -> heading of its column and digits
    "time_to_30": ("to 30 km/h [s]", 2),
    "distance": ("distance [m]", 1),
    "peak_slip": ("peak slip", 2),
    "mean_slip": ("mean slip", 3),
    "slip_energy": ("slip energy [kJ]", 1),
    "heading_deviation": ("heading [deg]", 1),
    "off_the_path": ("off the path [m]", 2),
    "torque_ripple": ("ripple [N m]", 1),
    "false_triggers": ("false triggers", 0),
    "recovery": ("torque back after [s]", 2),
}
COLUMNS = ("road", "asr", *(heading_ for heading_, _ in QUANTITIES.values()))
LEFT = 2
SUMMED = {  # over all roads: how, in which unit
    "distance": (sum, "m"),
    "mean_slip": (np.mean, "1"),
    "slip_energy": (lambda energies: sum(energies) * 1e3, "J"),
    "false_triggers": (sum, "1"),
}
SUMS = tuple(f"{quantity}_" for quantity in SUMMED)

SET_POINT = "speed_command.speed."
ASKED = 0.5  # when the driver begins to pull away [s]
REACHED = 30 / 3.6  # [m/s]
SERVED = 0.9  # of the request [1], from which on the torque counts as back
GRIP = 0.8  # friction in use [1] below which nothing had to be limited,
GRIP_TIME = 0.5  # if it was so for so long [s]
RIPPLE_WINDOW = 0.1  # [s]
TRACE_STEP = 0.02  # [s], between samples of the traced slip
PATH_STEP = 0.05  # [s], between samples that are compared with the path
STRAIGHT = 5.0  # length of a path before its bend [m]
BEND = 200.0  # [m]

VARIANTS = {  # methods of the role asr with another parameter than their own
    "least_squares_error_bound": ("least_squares", "largest_error", 0.001),
    "least_squares_square": ("least_squares", "template", "square"),
    "maximum_transmissible_torque_always": ("maximum_transmissible_torque", "limits", "always"),
    "slip_window_side_force": ("slip_window", "side_force.correction", "ellipse"),
}


def controls() -> list[str]:
    """All traction controls of the package that brings the node, and the variants, none first."""
    found = {*own_methods("asr"), *VARIANTS}
    found -= {"limp_home", "blended_brakes"}  # does nothing about slip; has the study `braking`
    return sorted(found, key=lambda name: (name != "off", name))


def values_of(control: str) -> tuple[tuple[str, str, Any], ...]:
    """The parameters of a control: (node, parameter, value)."""
    method, *changed = VARIANTS.get(control, (control,))
    values = [("asr", "method", method)]
    if changed:
        values.append(("asr", *changed))
    return tuple(values)


@dataclass(frozen=True, slots=True)
class Situation:
    """A road and the drive torque of all wheels that is asked for on it within a second [N m]."""

    torque: float
    left: tuple[str, ...]
    right: tuple[str, ...] = ()  # as left
    lengths: tuple[float, ...] = ()  # of the segments [m]; the same surface everywhere without
    grade: float = 0.0  # [1]
    curvature: float = 0.0  # of the path behind the first metres [1/m]

    def values(self) -> tuple[tuple[str, str, Any], ...]:
        """Values that differ from the scenario's own file."""
        values = [
            ("driver", "pedals.time", [0.0, 0.5, 0.7, 1.5]),
            ("driver", "pedals.drive_torque", [0.0, 0.0, 0.2 * self.torque, self.torque]),
            # holds the car on the hill
            ("driver", "pedals.brake_torque", [1000.0, 1000.0, 0.0, 0.0]),
            ("plant", "road.left", list(self.left)),
            ("plant", "road.right", list(self.right or self.left)),
            ("plant", "road.grade", [self.grade]),
        ]
        if self.lengths:
            values += [
                ("plant", "road.pattern", "segments"),
                ("plant", "road.length", list(self.lengths)),
            ]
        if self.curvature:
            values += [
                ("driver", "path.shape", "arcs"),
                ("driver", "path.length", [STRAIGHT, BEND]),
                ("driver", "path.curvature", [0.0, self.curvature]),
            ]
        return tuple(values)


SITUATIONS = {
    "ice": Situation(3000.0, ("ice",)),
    "snow": Situation(3000.0, ("packed_snow_1",)),
    "snow 2": Situation(3000.0, ("packed_snow_2",)),
    "wet": Situation(3000.0, ("wet_asphalt_1",)),
    "dry": Situation(3600.0, ("dry_asphalt",)),
    "dry, gentle": Situation(1500.0, ("dry_asphalt",)),
    "ice left, dry right": Situation(2400.0, ("ice",), ("dry_asphalt",)),
    "snow, then dry": Situation(2600.0, ("packed_snow_1", "dry_asphalt"), lengths=(10.0,)),
    "dry, then ice": Situation(2400.0, ("dry_asphalt", "ice"), lengths=(10.0,)),
    "snow, 5 % uphill": Situation(3000.0, ("packed_snow_1",), grade=0.05),
    "snow, bend of 25 m": Situation(3000.0, ("packed_snow_1",), curvature=0.04),
}


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """The quantities of the table by true slips and forces, and a slip of the front left over time.

    None is what a run has no number for, such as one that ends before the driver pulls away.
    """
    time = recording.time
    vehicle = run.configurations["asr"].common.vehicle
    wheels = [_wheel(recording, name, vehicle) for name in vehicle.driven_wheels]
    slips = np.array([each.slip for each in wheels])
    ripples = [each.ripple for each in wheels]
    step = _samples_in(TRACE_STEP, recording)
    # Before that the car is held by its brake.
    asked = slips[:, time >= ASKED]
    reached = metric(lambda: crossing_time(time, speed(recording), REACHED, "30 km/h"), "s")
    return {
        "time_to_30": reached.value,
        "distance": float(distance_on_path(recording)[-1]),
        "peak_slip": float(asked.max()) if asked.size else None,
        "mean_slip": float(asked.mean()) if asked.size else None,
        "slip_energy": float(sum(each.energy for each in wheels)) / 1e3,
        "heading_deviation": math.degrees(float(np.abs(heading(recording)).max())),
        "off_the_path": _farthest(recording, run),
        "torque_ripple": None if None in ripples else float(np.mean(ripples)),
        "false_triggers": sum(each.false_triggers for each in wheels),
        "recovery": _recovery(recording, vehicle),
        "trace_time": time[::step],
        "trace_slip": slips[0, ::step],
    }


def _samples_in(seconds: float, recording: Recording) -> int:
    """Number of samples in a time, one at least."""
    return max(round(seconds * (len(recording.time) - 1) / recording.duration), 1)


def _given(recording: Recording, name: str, vehicle: Vehicle) -> tuple[np.ndarray, np.ndarray]:
    """The torque that the control gives a wheel [N m], and where it limits it.

    A drive in speed mode makes its torque itself.
    """
    command = channel(recording, f"torque_command.drive.{name}")
    if SET_POINT + name not in recording.channels:
        # In torque mode the control limits where it gives less than is asked for.
        return command, command < channel(recording, f"torque_request.drive.{name}")
    gear = drive_train_numbers(vehicle)["gear"][WHEEL_NAMES.index(name)]
    # A set-point beyond the largest speed of the motor limits nothing (docs/asr.md).
    in_reach = channel(recording, SET_POINT + name) < vehicle.motor.maximum_speed / gear
    effort = channel(recording, f"wheel_states.effort.{name}")
    return effort / vehicle.motor.gear_efficiency, in_reach


def _farthest(recording: Recording, run: Run) -> float:
    """The largest distance of the centre of mass from the driver's path [m]."""
    path = path_of(run.configurations["driver"].parameters.path)
    step = _samples_in(PATH_STEP, recording)
    x = channel(recording, "pose.x")[::step].tolist()
    y = channel(recording, "pose.y")[::step].tolist()
    leg = 0
    farthest = 0.0
    for at_x, at_y in zip(x, y, strict=True):
        distance, leg = nearest(path, at_x, at_y, leg)
        on_x, on_y = point_at(path, distance, leg)
        farthest = max(farthest, hypot(at_x - on_x, at_y - on_y))
    return farthest


class _Wheel(NamedTuple):
    """Measures of one driven wheel."""

    slip: np.ndarray  # over time
    energy: float  # lost by slip [J]
    ripple: float | None  # [N m]
    false_triggers: int


def _wheel(recording: Recording, name: str, vehicle: Vehicle) -> _Wheel:
    def of_tyre(quantity: str) -> np.ndarray:
        return channel(recording, f"tire_forces.{quantity}.{name}")

    # At least 1 N: a lifted wheel would divide by zero.
    grip = np.maximum(of_tyre("load") * of_tyre("friction_coefficient"), 1.0)
    use = np.abs(of_tyre("longitudinal_force")) / grip
    given, limited = _given(recording, name, vehicle)
    before = _samples_in(GRIP_TIME, recording)
    false = 0
    for begin in np.flatnonzero(limited[1:] & ~limited[:-1]) + 1:
        # A limitation begins here though the tyre was far from its limit all the time before.
        false += bool(use[max(begin - before, 0) : begin + 1].max() < GRIP)
    # Only what is lost; noise of a rolling wheel has either sign.
    power = np.maximum(slip_powers(recording, vehicle, name)[0], 0.0)
    energy = float(np.trapezoid(power, recording.time))
    return _Wheel(of_tyre("slip_ratio"), energy, _ripple(given, recording.time), false)


def _ripple(values: np.ndarray, time: np.ndarray) -> float | None:
    """Root mean square of values less their mean over RIPPLE_WINDOW around each instant."""
    half = RIPPLE_WINDOW / 2
    middle = (time[:-1] + time[1:]) / 2  # of a period, in which a command holds
    inner = (middle >= time[0] + half) & (middle <= time[-1] - half)
    if not inner.any():
        return None
    # The integral of a command that holds over each period, so that means over any window are
    # exact.
    held = np.concatenate(([0.0], np.cumsum(values[:-1] * np.diff(time))))
    before = np.interp(middle[inner] - half, time, held)
    after = np.interp(middle[inner] + half, time, held)
    return float(np.sqrt(np.mean((values[:-1][inner] - (after - before) / RIPPLE_WINDOW) ** 2)))


def _recovery(recording: Recording, vehicle: Vehicle) -> float | None:
    """Longest time [s] from a rise of the friction until a wheel gets most of its request.

    None without a rise, or if a wheel never gets it.
    """
    times = []
    for name in vehicle.driven_wheels:
        friction = channel(recording, f"tire_forces.friction_coefficient.{name}")
        rises = np.flatnonzero(np.diff(friction) > 0.0)
        if not len(rises):
            continue
        # The last rise: behind it the friction stays.
        risen = rises[-1] + 1
        least = SERVED * channel(recording, f"torque_request.drive.{name}")
        given, _ = _given(recording, name, vehicle)
        back = np.flatnonzero((given >= least)[risen:])
        if not len(back):
            return None
        times.append(float(recording.time[risen + back[0]] - recording.time[risen]))
    return max(times, default=None)


def add_options(parser: argparse.ArgumentParser) -> None:
    """A part of the controls and roads instead of all."""
    add_choice(parser, "--controls", controls(), "ASR")
    add_choice(parser, "--roads", SITUATIONS, "ROAD")


def _chosen(given: argparse.Namespace) -> tuple[list[str], list[str]]:
    roads = getattr(given, "roads", None) or list(SITUATIONS)
    return roads, getattr(given, "controls", None) or controls()


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Every control on every road."""
    roads, names = _chosen(given)
    found = []
    for road in roads:
        for name in names:
            values = (*COMMON, *SITUATIONS[road].values(), *values_of(name))
            found.append(Case(name_of(road, name), SCENARIO, values, RUN, duration=DURATION))
    return found


def name_of(road: str, control: str) -> str:
    """Name of a case."""
    return f"{road}: {control}"


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """Sums over all roads for each control."""
    roads, names = _chosen(given)

    found = {}
    for name in names:
        measured = [results[name_of(road, name)].measured for road in roads]
        for quantity, (add, unit) in SUMMED.items():
            values = np.array([of.get(quantity) for of in measured], float)
            found[f"{quantity}_{name}"] = metric(partial(add, values), unit)
    return found


def rows(given: argparse.Namespace, results: Results) -> list[tuple[str, ...]]:
    """Road, control and what was measured; a dash where 30 km/h were not reached."""
    return rows_of_cases(results, {name: f".{digits}f" for name, (_, digits) in QUANTITIES.items()})


def figures(given: argparse.Namespace, results: Results) -> dict[str, Sheet]:
    """The slip of the front left wheel over time on some roads, with some controls."""
    roads, names = _chosen(given)
    panels = []
    for road in [each for each in TRACED if each in roads] or roads[:1]:
        curves = []
        for name in DRAWN:
            measured = results[name_of(road, name)].measured if name in names else {}
            if measured:
                curve = Curve(measured["trace_time"], measured["trace_slip"], readable(name))
                curves.append(curve)
        title = f"{road}: slip of the front left wheel"
        panels.append(Panel(title, "slip ratio [1]", tuple(curves)))
    return {"slip": Sheet(panels)}
