"""Every traction control on every road: pulling away, split friction, jumps of friction, a hill, a bend."""

from __future__ import annotations

import argparse
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ev_core.lockstep.finding import find_method
from ev_core.methods.register import methods_of, node_package
from ev_msgs_py.contract.roles import MASTER
from ev_sim.figures.drawing import sheet
from ev_sim.figures.figure import Figure
from ev_sim.figures.panels import Curve, Panel
from ev_sim.measures.metric import Metric, metric
from ev_sim.study.asr_measured import PERIOD
from ev_sim.study.asr_measured import measure as measure
from ev_sim.study.study import Case, Results

VARIANTS = {  # methods of the role asr with another parameter than their own
    "least_squares_error_bound": ("least_squares", "largest_error", 0.001),
    "least_squares_square": ("least_squares", "template", "square"),
    "maximum_transmissible_torque_always": ("maximum_transmissible_torque", "limits", "always"),
    "slip_window_side_force": ("slip_window", "side_force.correction", "ellipse"),
}


def controls() -> list[str]:
    """All traction controls of the package that brings the node, and the variants, none first."""
    names = [name for name, method in methods_of("asr").items() if method.package == node_package("asr")]
    names.remove("limp_home")  # does nothing about slip
    names.remove("blended_brakes")  # of the study `braking`
    return sorted((*names, *VARIANTS), key=lambda name: (name != "off", name))


def values_of(control: str) -> tuple[tuple[str, str, Any], ...]:
    """The parameters of a control, and of the plant if it needs a certain one: (node, parameter, value)."""
    method, *changed = VARIANTS.get(control, (control,))
    plant = find_method("asr", method).requires.get(MASTER)
    values = [("asr", "method", method), *([("asr", *changed)] if changed else [])]
    return (*values, (MASTER, "method", plant)) if plant else tuple(values)


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
        """What differs from the scenario's own file."""
        values = [
            ("driver", "pedals.time", [0.0, 0.5, 0.7, 1.5]),
            ("driver", "pedals.drive_torque", [0.0, 0.0, 0.2 * self.torque, self.torque]),
            ("driver", "pedals.brake_torque", [1000.0, 1000.0, 0.0, 0.0]),  # holds the car on the hill
            ("plant", "road.left", list(self.left)),
            ("plant", "road.right", list(self.right or self.left)),
            ("plant", "road.grade", [self.grade]),
        ]
        if self.lengths:
            values += [("plant", "road.pattern", "segments"), ("plant", "road.length", list(self.lengths))]
        if self.curvature:
            values += [("driver", "path.shape", "arcs"), ("driver", "path.length", [STRAIGHT, BEND])]
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


ABOUT = "All traction controls pulling away on ice, snow, wet and dry roads, split friction, friction jumps, hill, bend"
SCENARIO, RUN = "launch_split_mu", "steered"
DURATION = 8.0  # [s]
SHORTEST = 1.0  # [s]; the driver asks for torque from 0.5 s on
NOISE = {"wheel_speed": 0.03, "wheel_torque": 0.5, "imu_acceleration": 0.05, "imu_yaw_rate": 0.002}
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
SUMS = ("distance_", "mean_slip_", "slip_energy_", "false_triggers_")


def add_options(parser: argparse.ArgumentParser) -> None:
    """A part of the controls and roads instead of all."""
    parser.add_argument("--controls", nargs="+", choices=controls(), metavar="ASR", help="these only; default: all")
    parser.add_argument("--roads", nargs="+", choices=list(SITUATIONS), metavar="ROAD", help="these only; default: all")


def _chosen(given: argparse.Namespace) -> tuple[list[str], list[str]]:
    """Roads and controls of the study."""
    return getattr(given, "roads", None) or list(SITUATIONS), getattr(given, "controls", None) or controls()


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Every control on every road."""
    common = (
        ("*", "control_period", PERIOD),
        *(("plant", f"sensors.{sensor}.noise", deviation) for sensor, deviation in NOISE.items()),
    )
    roads, names = _chosen(given)
    return [
        Case(
            name_of(road, control),
            SCENARIO,
            (*common, *SITUATIONS[road].values(), *values_of(control)),
            RUN,
            duration=DURATION,
        )
        for road in roads
        for control in names
    ]


def name_of(road: str, control: str) -> str:
    """Name of a case."""
    return f"{road}: {control}"


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """For each control the sums over all roads."""
    roads, names = _chosen(given)

    def all_of(control: str, quantity: str) -> list[float]:
        found = (results[name_of(road, control)].measured.get(quantity) for road in roads)
        return [math.nan if value is None else value for value in found]

    summed = {}
    for name in names:
        summed[f"distance_{name}"] = metric(lambda n=name: sum(all_of(n, "distance")), "m")
        summed[f"mean_slip_{name}"] = metric(lambda n=name: np.mean(all_of(n, "mean_slip")), "1")
        summed[f"slip_energy_{name}"] = metric(lambda n=name: sum(all_of(n, "slip_energy")) * 1e3, "J")
        summed[f"false_triggers_{name}"] = metric(lambda n=name: sum(all_of(n, "false_triggers")), "1")
    return summed


def rows(given: argparse.Namespace, results: Results) -> list[tuple[str, ...]]:
    """Road, control and what was measured; a dash where 30 km/h were not reached."""

    def shown(value: float | None, digits: int) -> str:
        return "–" if value is None else f"{value:.{digits}f}"

    def numbers(of: Mapping[str, Any]) -> tuple[str, ...]:
        return tuple(shown(of.get(key), digits) for key, (_, digits) in QUANTITIES.items())

    return [(*name.split(": "), *numbers(result.measured)) for name, result in results.items()]


def figures(given: argparse.Namespace, results: Results) -> dict[str, Figure]:
    """The slip of the front left wheel over time on some roads, with some controls."""
    roads, names = _chosen(given)
    panels = []
    for road in [road for road in TRACED if road in roads] or roads[:1]:
        drawn = [results[name_of(road, name)] for name in DRAWN if name in names]
        curves = [
            Curve(result.measured["trace_time"], result.measured["trace_slip"], result.name.partition(": ")[2])
            for result in drawn
            if result.measured
        ]
        panels.append(Panel(f"{road}: slip of the front left wheel", "slip ratio [1]", tuple(curves)))
    return {"slip": sheet(panels, "time [s]")}
