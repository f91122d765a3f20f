"""Every electronic differential on the same car in one scenario: handling, slip and energy side by side."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ev_core.methods.register import methods_of
from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.refusal import unknown_name
from ev_sim.figures.drawing import Curve, Figure, panel, sheet
from ev_sim.figures.other_axes import plan_view
from ev_sim.measures import handling, motion
from ev_sim.measures.metric import Metric, NotMeasured, channel
from ev_sim.recording.recording import Recording
from ev_sim.report.tables import text_table
from ev_sim.scenarios.scenario import Run, load_scenario
from ev_sim.study.study import Case, CaseResult, Results
from ev_sim.surfaces import RoadParameters, Surface, left_and_right

ABOUT = "Every electronic differential on the same car in any scenario, one table and one figure"
ROLE = "electronic_differential"
ALL = "all"
QUANTITIES = {  # name -> unit, in the order of the columns
    "peak_sideslip": "rad",
    "yaw_rate_error": "rad/s",
    "peak_slip": "1",
    "slip_energy": "J",
    "drive_energy": "J",
    "time_over_limit": "s",
}
COLUMNS = ("method", *(f"{name} [{unit}]" for name, unit in QUANTITIES.items()))
CURVES = {  # over time, with their units
    "x": "m", "y": "m", "yaw_rate": "rad/s", "sideslip": "deg", "speed": "m/s", "torque_difference": "N m"
}  # fmt: skip


def add_options(parser: argparse.ArgumentParser) -> None:
    """Which scenario, which of its runs, which methods."""
    parser.add_argument("--scenario", default="double_lane_change", help="default: %(default)s")
    parser.add_argument("--run", default="", help="of a scenario with several runs; default: the first")
    parser.add_argument("--methods", default=ALL, metavar="NAME,NAME", help="default: all that are registered")


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """One case for each method; ParameterError for an unknown scenario, run or method."""
    runs = load_scenario(given.scenario).runs
    run = given.run or runs[0].name
    if run not in {r.name for r in runs}:
        raise unknown_name(f"run of {given.scenario}", run, [r.name for r in runs])
    known = methods_of(ROLE)
    chosen = list(known) if given.methods == ALL else given.methods.split(",")
    for name in chosen:
        if name not in known:
            raise unknown_name(f"{ROLE} method", name, known)
    return [Case(name, given.scenario, ((ROLE, "method", name),), run) for name in dict.fromkeys(chosen)]


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """QUANTITIES, or in one line why one cannot be measured, and CURVES."""
    plant = run.configurations[MASTER]
    vehicle, surfaces = plant.common.vehicle, surfaces_of(getattr(plant.told, "road", None))
    return {
        "peak_sideslip": handling.peak_sideslip(recording),
        "yaw_rate_error": _if_measured(lambda: handling.yaw_rate_error(recording, vehicle)),
        "peak_slip": _if_measured(lambda: handling.peak_slip_ratio(recording)),
        "slip_energy": _if_measured(lambda: handling.slip_energy(recording, vehicle)),
        "drive_energy": float(handling.drive_work(recording)[-1]),
        "time_over_limit": _if_measured(lambda: handling.time_over_limit(recording, vehicle, surfaces)),
        "time": recording.time,
        "x": channel(recording, "pose.x"),
        "y": channel(recording, "pose.y"),
        "yaw_rate": channel(recording, motion.YAW_RATE),
        "sideslip": np.degrees(motion.sideslip_angle(recording)),
        "speed": motion.path_speed(recording),
        "torque_difference": _right_minus_left(recording),
    }


def surfaces_of(road: RoadParameters | None) -> tuple[Surface, ...]:
    """The surfaces that lie on a road; none of a plant that has none."""
    if road is None:
        return ()
    return tuple(map(road.surface, dict.fromkeys(name for side in left_and_right(road) for name in side.surface)))


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """Each quantity of each method that could be driven."""
    return {
        f"{quantity}_{name}": _metric(result.measured[quantity], unit)
        for name, result in results.items()
        if not result.refused
        for quantity, unit in QUANTITIES.items()
    }


def table(given: argparse.Namespace, results: Results) -> tuple[Sequence[str], list[list[Any]]]:
    """Columns, and for each method that could be driven a row of its quantities."""
    driven = [(name, of.measured) for name, of in results.items() if not of.refused]
    return COLUMNS, [[name, *(_number(measured[quantity]) for quantity in QUANTITIES)] for name, measured in driven]


def tables(given: argparse.Namespace, results: Results) -> str:
    """The quantities of each method that could be driven."""
    rows = [(marked(name, results[name]), *map(_cell, values)) for name, *values in table(given, results)[1]]
    return text_table(COLUMNS, rows, left=COLUMNS[:1])


def figures(given: argparse.Namespace, results: Results) -> dict[str, Figure]:
    """Paths, and yaw rate, sideslip angle, speed and torque difference over time, all methods one over the other."""
    driven = {name: result for name, result in results.items() if not result.refused}

    def over_time(title: str, ylabel: str, quantity: str):
        return panel(title, ylabel, lambda: [_curve(name, of, "time", quantity) for name, of in driven.items()])

    panels = [
        over_time("Yaw rate", "yaw rate [rad/s]", "yaw_rate"),
        over_time("Sideslip angle", "angle [deg]", "sideslip"),
        over_time("Speed", "speed [m/s]", "speed"),
        over_time("Torque request, right minus left", "torque [N m]", "torque_difference"),
    ]
    tracks = [_curve(name, of, "x", "y") for name, of in driven.items()]
    return {"overlay": sheet(panels, "time [s]"), "paths": plan_view(f"Paths, {given.scenario}", tracks)}


def _curve(name: str, of: CaseResult, x: str, y: str) -> Curve:
    return Curve(of.measured[x], of.measured[y], marked(name, of), spun=of.spun)


def marked(name: str, of: CaseResult) -> str:
    """The name of a law, and that the car has spun with it."""
    return f"{name} (spun)" if of.spun else name


def _right_minus_left(recording: Recording) -> np.ndarray:
    def of(side: str) -> np.ndarray:
        return sum(channel(recording, f"torque_request.drive.{axle}_{side}") for axle in ("front", "rear"))

    return of("right") - of("left")


def _if_measured(measure: Callable[[], float]) -> float | str:
    try:
        return measure()
    except NotMeasured as why:
        return str(why)


def _metric(value: float | str, unit: str) -> Metric:
    return Metric(None, unit, reason=value) if isinstance(value, str) else Metric(value, unit)


def _number(value: float | str) -> float | None:
    return None if isinstance(value, str) else value


def _cell(value: float | None) -> str:
    return "-" if value is None or not math.isfinite(value) else f"{value:.4g}"
