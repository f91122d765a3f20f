"""Every electronic differential on the same car in one scenario: handling, slip and energy side by side."""

from __future__ import annotations

import argparse
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ev_core.lockstep.finding import find_method, is_code
from ev_core.methods.register import methods_of
from ev_msgs_py.refusal import ParameterError, unknown_name
from ev_stack.command_line.options import add_metrics
from ev_stack.figures.other_axes import plan_view
from ev_stack.figures.panels import Curve, Panel, readable
from ev_stack.figures.sheets import Sheet
from ev_stack.measures import motion
from ev_stack.measures.metric import Metric, channel
from ev_stack.measures.own_metrics import listed
from ev_stack.measures.registry import METRICS
from ev_stack.recording.recording import Recording
from ev_stack.report.reports import further_metrics, measured_metrics, row_of
from ev_stack.report.tables import Table, tables_by_width
from ev_stack.scenarios.records import Run
from ev_study.studies.metric_table import (
    Units,
    metric_table,
    not_measured,
    shown_metrics,
    values_of,
)
from ev_study.studies.study import Case, CaseResult, Results, run_of_command

ABOUT = "Every electronic differential on the same car in any scenario, one table and one figure"
ROLE = "electronic_differential"
ALL = "all"
QUANTITIES = (
    "peak_sideslip",
    "yaw_rate_error",
    "peak_slip",
    "slip_energy",
    "drive_energy",
    "time_over_limit",
)
CURVES = {  # over time, with their units
    "x": "m", "y": "m", "yaw_rate": "rad/s", "sideslip": "deg", "speed": "m/s", "torque_difference": "N m"
}  # fmt: skip
FIRST_CURVES = ("yaw_rate", "sideslip", "speed", "torque_difference")


def add_options(parser: argparse.ArgumentParser) -> None:
    """Options for the scenario, its runs and the methods."""
    parser.add_argument("--scenario", default="double_lane_change", help="default: %(default)s")
    parser.add_argument(
        "--run", default="", help="of a scenario with several runs; default: the first"
    )
    parser.add_argument(
        "--methods",
        default=ALL,
        metavar="NAME,NAME",
        help="or my_law.py[:NAME]; default: all that are registered",
    )
    add_metrics(parser, f"default: {', '.join(QUANTITIES)}")


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """One case for each method; ParameterError for an unknown scenario, run, method or metric."""
    run = run_of_command(given)
    known = methods_of(ROLE)
    chosen = list(known) if given.methods == ALL else given.methods.split(",")
    # Columns and files are called by these names, so two methods cannot share one.
    names = {}
    for method in dict.fromkeys(chosen):
        if not is_code(method) and method not in known:
            raise unknown_name(f"{ROLE} method", method, known)
        # Raises for a file that cannot be loaded, before anything is driven.
        find_method(ROLE, method)
        name = _name_of(method)
        if name in names:
            raise ParameterError(
                f"--methods: {names[name]} and {method} are both called {name}, expected two names"
            )
        names[name] = method
    # The usual ones are measured where they can be, those that are asked for have to be.
    metrics = further_metrics(run, listed(given.metrics) or QUANTITIES, bool(given.metrics))
    return [
        Case(name, given.scenario, ((ROLE, "method", method),), run.name, metrics=metrics)
        for name, method in names.items()
    ]


def _name_of(method: str) -> str:
    """The name of a method in tables and figures: of a file that of the chosen law, or of the file."""
    code, _, chosen = method.partition(":")
    return (chosen or Path(code).stem) if is_code(method) else method


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """Every metric of the run, in one line why one cannot be measured, and CURVES."""
    return {
        **row_of(measured_metrics(recording, run)),
        "time": recording.time,
        "x": channel(recording, "pose.x"),
        "y": channel(recording, "pose.y"),
        "yaw_rate": channel(recording, motion.YAW_RATE),
        "sideslip": np.degrees(motion.sideslip_in_motion(recording)),
        "speed": motion.path_speed(recording),
        "torque_difference": _right_minus_left(recording),
    }


def _shown(given: argparse.Namespace, results: Results) -> Units:
    return shown_metrics(listed(given.metrics) or QUANTITIES, results)


def _driven(results: Results) -> dict[str, CaseResult]:
    """Results of the methods that could be driven."""
    return {law: result for law, result in results.items() if not result.refused}


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """Each metric of each method that could be driven."""
    shown = _shown(given, results)
    found = {}
    for law, result in _driven(results).items():
        # Every metric that is shown for any law: where one lacks, its reason is kept.
        for name, unit in shown.items():
            found[f"{name}_{law}"] = Metric(
                values_of(result).get(name),
                unit,
                reason=result.measured["reasons"].get(name, ""),
                better=METRICS[name].better if name in METRICS else "",
            )
    return found


def table(given: argparse.Namespace, results: Results) -> Table:
    """A row of metrics for each method that could be driven."""
    called = [((law,), result) for law, result in _driven(results).items()]
    return metric_table(("method",), called, _shown(given, results))


def tables(given: argparse.Namespace, results: Results) -> str:
    """The metrics of each method that could be driven."""
    found = table(given, results)
    texts = []
    for law, *values in found.rows:
        numbers = ("-" if value is None else f"{value:.4g}" for value in values)
        texts.append((marked(law, results[law]), *numbers))
    shown = tables_by_width(found.columns, texts, 1, left=found.columns[:1])
    lacking = not_measured(_shown(given, results), results)
    return "\n".join(filter(None, (shown, lacking)))


def figures(given: argparse.Namespace, results: Results) -> dict[str, Sheet]:
    """Paths, and yaw rate, sideslip angle, speed and torque difference over time, all methods one over the other."""
    driven = _driven(results)

    def over_time(title: str, ylabel: str, quantity: str, factor: float = 1.0) -> Panel:
        curves = [_curve(name, of, "time", quantity, factor) for name, of in driven.items()]
        return Panel(title, ylabel, curves)

    panels = [
        over_time("Yaw rate", "yaw rate [deg/s]", "yaw_rate", math.degrees(1.0)),
        over_time("Sideslip angle", "angle [deg]", "sideslip"),
        over_time("Speed", "speed [m/s]", "speed"),
        over_time("Torque request, right minus left", "torque [N m]", "torque_difference"),
    ]
    # The plan view is a sheet of its own: its axes have equal scales.
    tracks = [_curve(name, of, "x", "y") for name, of in driven.items()]
    return {"overlay": Sheet(panels), "paths": plan_view(f"Paths, {given.scenario}", tracks)}


def _curve(name: str, of: CaseResult, x: str, y: str, factor: float = 1.0) -> Curve:
    return Curve(of.measured[x], factor * of.measured[y], readable(marked(name, of)), spun=of.spun)


def marked(name: str, of: CaseResult) -> str:
    """The name of a law, and that the car has spun with it."""
    return f"{name} (spun)" if of.spun else name


def _right_minus_left(recording: Recording) -> np.ndarray:
    def of(side: str) -> np.ndarray:
        return sum(
            channel(recording, f"torque_request.drive.{axle}_{side}") for axle in ("front", "rear")
        )

    return of("right") - of("left")
