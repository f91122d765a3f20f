"""Every traction control on every road: pulling away, split friction, jumps of friction, a hill, a bend."""

from __future__ import annotations

import argparse
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

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
from ev_study.studies.study import Case, Results, own_methods, rows_of_cases

VARIANTS = {  # methods of the role asr with another parameter than their own
    "least_squares_error_bound": ("least_squares", "largest_error", 0.001),
    "least_squares_square": ("least_squares", "template", "square"),
    "maximum_transmissible_torque_always": ("maximum_transmissible_torque", "limits", "always"),
    "slip_window_side_force": ("slip_window", "side_force.correction", "ellipse"),
}


def controls() -> list[str]:
    """All traction controls of the package that brings the node, and the variants, none first."""
    others = {"limp_home", "blended_brakes"}  # does nothing about slip; has the study `braking`
    return sorted({*own_methods("asr"), *VARIANTS} - others, key=lambda name: (name != "off", name))


def values_of(control: str) -> tuple[tuple[str, str, Any], ...]:
    """The parameters of a control: (node, parameter, value)."""
    method, *changed = VARIANTS.get(control, (control,))
    of_asr = [("method", method), *([changed] if changed else [])]
    return tuple(("asr", *each) for each in of_asr)


STRAIGHT, BEND = 5.0, 200.0  # lengths of a path with a bend [m]


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
            ]
            values.append(("driver", "path.curvature", [0.0, self.curvature]))
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


SET_POINT = "speed_command.speed."
PERIOD = 0.005  # of control, with which the runs are driven [s]
ASKED = 0.5  # when the driver begins to pull away [s]
REACHED = 30 / 3.6  # [m/s]
SERVED = 0.9  # of the request [1], from which on the torque counts as back
# friction in use below which for so long nothing had to be limited [1, s]
GRIP, GRIP_TIME = 0.8, 0.5
RIPPLE_WINDOW = 0.1  # [s]
# [s], between samples of the traced slip, and those compared with the path
TRACE_STEP, PATH_STEP = 0.02, 0.05


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """The quantities of the table, by the true slips and forces, and the slip of the front left wheel over time.

    None is what a run has no number for, such as one that ends before the driver pulls away.
    """
    time = recording.time
    vehicle = run.configurations["asr"].common.vehicle
    wheels = zip(*(_wheel(recording, name, vehicle) for name in vehicle.driven_wheels), strict=True)
    slips, energies, ripples, triggers = map(np.array, wheels)
    step = _samples_in(TRACE_STEP, recording)
    asked = slips[:, time >= ASKED]
    return {
        "time_to_30": metric(
            lambda: crossing_time(time, speed(recording), REACHED, "30 km/h"), "s"
        ).value,
        "distance": float(distance_on_path(recording)[-1]),
        "peak_slip": float(asked.max()) if asked.size else None,
        "mean_slip": float(asked.mean()) if asked.size else None,
        "slip_energy": float(sum(energies)) / 1e3,
        "heading_deviation": math.degrees(float(np.abs(heading(recording)).max())),
        "off_the_path": _farthest(recording, run),
        "torque_ripple": None if None in ripples else float(np.mean(ripples)),
        "false_triggers": int(sum(triggers)),
        "recovery": _recovery(recording, vehicle),
        "trace_time": time[::step],
        "trace_slip": slips[0, ::step],
    }


def _samples_in(seconds: float, recording: Recording) -> int:
    """Number of samples in a time, one at least."""
    return max(round(seconds * (len(recording.time) - 1) / recording.duration), 1)


def _given(recording: Recording, name: str, vehicle: Vehicle) -> tuple[np.ndarray, np.ndarray]:
    """The torque that the control gives a wheel [N m], and where it limits it; a drive in speed mode has its own."""
    command = channel(recording, f"torque_command.drive.{name}")
    if SET_POINT + name not in recording.channels:
        return command, command < channel(recording, f"torque_request.drive.{name}")
    gear = drive_train_numbers(vehicle)["gear"][WHEEL_NAMES.index(name)]
    in_reach = channel(recording, SET_POINT + name) < vehicle.motor.maximum_speed / gear
    return channel(
        recording, f"wheel_states.effort.{name}"
    ) / vehicle.motor.gear_efficiency, in_reach


def _farthest(recording: Recording, run: Run) -> float:
    """The largest distance of the centre of mass from the driver's path [m]."""
    path, leg, farthest = path_of(run.configurations["driver"].parameters.path), 0, 0.0
    step = _samples_in(PATH_STEP, recording)
    for at_x, at_y in zip(
        *(channel(recording, f"pose.{of}")[::step].tolist() for of in ("x", "y")), strict=True
    ):
        distance, leg = nearest(path, at_x, at_y, leg)
        on_x, on_y = point_at(path, distance, leg)
        farthest = max(farthest, hypot(at_x - on_x, at_y - on_y))
    return farthest


def _wheel(
    recording: Recording, name: str, vehicle: Vehicle
) -> tuple[np.ndarray, float, float | None, int]:
    """Measures of one driven wheel: slip over time, energy [J], ripple [N m], false triggers."""
    time = recording.time
    of_tyre = ("slip_ratio", "longitudinal_force", "load", "friction_coefficient")
    slip, force, load, friction = (channel(recording, f"tire_forces.{of}.{name}") for of in of_tyre)
    given, limited = _given(recording, name, vehicle)
    begins = np.flatnonzero(limited[1:] & ~limited[:-1]) + 1
    use = np.abs(force) / np.maximum(load * friction, 1.0)
    before = _samples_in(GRIP_TIME, recording)
    false = sum(float(use[max(i - before, 0) : i + 1].max()) < GRIP for i in begins)
    energy = float(np.trapezoid(np.maximum(slip_powers(recording, vehicle, name)[0], 0.0), time))
    return slip, energy, _ripple(given, time), false


def _ripple(values: np.ndarray, time: np.ndarray) -> float | None:
    """Root mean square of values less their mean over RIPPLE_WINDOW around each instant, in their unit."""
    # of a period, in which a command holds
    half, middle = RIPPLE_WINDOW / 2, (time[:-1] + time[1:]) / 2
    inner = (middle >= time[0] + half) & (middle <= time[-1] - half)
    if not inner.any():
        return None
    held = np.concatenate(([0.0], np.cumsum(values[:-1] * np.diff(time))))
    before, after = (np.interp(middle[inner] + side * half, time, held) for side in (-1.0, 1.0))
    return float(np.sqrt(np.mean((values[:-1][inner] - (after - before) / RIPPLE_WINDOW) ** 2)))


def _recovery(recording: Recording, vehicle: Vehicle) -> float | None:
    """Longest time [s] from a rise of the friction until a wheel gets most of its request."""
    times = []
    for name in vehicle.driven_wheels:
        rises = np.flatnonzero(
            np.diff(channel(recording, f"tire_forces.friction_coefficient.{name}")) > 0.0
        )
        if len(rises):
            least = SERVED * channel(recording, f"torque_request.drive.{name}")
            risen = rises[-1] + 1
            back = np.flatnonzero((_given(recording, name, vehicle)[0] >= least)[risen:])
            times.append(
                float(recording.time[risen + back[0]] - recording.time[risen])
                if len(back)
                else math.inf
            )
    return max(times) if times and max(times) < math.inf else None


ABOUT = "All traction controls pulling away on ice, snow, wet and dry roads, split friction, friction jumps, hill, bend"
SCENARIO, RUN = "launch_split_mu", "steered"
DURATION = 8.0  # [s]
SHORTEST = 1.0  # [s]; the driver asks for torque from 0.5 s on
NOISE = {"wheel_speed": 0.03, "wheel_torque": 0.5, "imu_acceleration": 0.05, "imu_yaw_rate": 0.002}
COMMON = [
    ("*", "control_period", PERIOD),
    *(("plant", f"sensors.{of}.noise", noise) for of, noise in NOISE.items()),
]
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


def add_options(parser: argparse.ArgumentParser) -> None:
    """A part of the controls and roads instead of all."""
    parser.add_argument(
        "--controls", nargs="+", choices=controls(), metavar="ASR", help="these only; default: all"
    )
    parser.add_argument(
        "--roads",
        nargs="+",
        choices=list(SITUATIONS),
        metavar="ROAD",
        help="these only; default: all",
    )


def _chosen(given: argparse.Namespace) -> tuple[list[str], list[str]]:
    return getattr(given, "roads", None) or list(SITUATIONS), getattr(
        given, "controls", None
    ) or controls()


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Every control on every road."""
    common = (
        ("*", "control_period", PERIOD),
        *(("plant", f"sensors.{sensor}.noise", deviation) for sensor, deviation in NOISE.items()),
    )
    roads, names = _chosen(given)
    return [
        Case(
            name_of(road, name),
            SCENARIO,
            (*common, *SITUATIONS[road].values(), *values_of(name)),
            RUN,
            duration=DURATION,
        )
        for road in roads
        for name in names
    ]


def name_of(road: str, control: str) -> str:
    """Name of a case."""
    return f"{road}: {control}"


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """Sums over all roads for each control."""
    roads, names = _chosen(given)

    def all_of(control: str, quantity: str) -> np.ndarray:
        return np.array(
            [results[name_of(road, control)].measured.get(quantity) for road in roads], float
        )

    return {
        f"{quantity}_{name}": metric(partial(add, all_of(name, quantity)), unit)
        for name in names
        for quantity, (add, unit) in SUMMED.items()
    }


def rows(given: argparse.Namespace, results: Results) -> list[tuple[str, ...]]:
    """Road, control and what was measured; a dash where 30 km/h were not reached."""
    return rows_of_cases(results, {name: f".{digits}f" for name, (_, digits) in QUANTITIES.items()})


def figures(given: argparse.Namespace, results: Results) -> dict[str, Sheet]:
    """The slip of the front left wheel over time on some roads, with some controls."""
    roads, names = _chosen(given)
    panels = []
    for road in [each for each in TRACED if each in roads] or roads[:1]:
        curves = [
            Curve(measured["trace_time"], measured["trace_slip"], readable(name))
            for name in DRAWN
            if name in names and (measured := results[name_of(road, name)].measured)
        ]
        panels.append(
            Panel(f"{road}: slip of the front left wheel", "slip ratio [1]", tuple(curves))
        )
    return {"slip": Sheet(panels)}
