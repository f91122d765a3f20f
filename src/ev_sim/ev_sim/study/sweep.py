"""Any parameters of any scenario over values and seeds: a row of metrics for each run, as table and figures."""

from __future__ import annotations

import argparse
import itertools
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import yaml

from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.refusal import ParameterError, quoted
from ev_sim.figures.other_axes import band, colour_map
from ev_sim.figures.panels import IN_FIGURES, readable
from ev_sim.figures.sheets import Sheet
from ev_sim.measures.metric import Metric, own_metrics
from ev_sim.recording.recording import Recording
from ev_sim.report.result import report_for
from ev_sim.report.tables import cell, text_table
from ev_sim.scenarios.parameter_file import read_yaml
from ev_sim.scenarios.scenario import Run, load_scenario
from ev_sim.study.study import Case, Results

ABOUT = "Any parameters of any scenario over values and seeds - a row for each run, lines with bands or maps"
SEED = "seed"


def add_options(parser: argparse.ArgumentParser) -> None:
    """Which scenario, what varies, and what is shown of it."""
    parser.add_argument("scenario", nargs="?", default="double_lane_change", help="name or path; default: %(default)s")
    parser.add_argument("--run", default="", help="of a scenario with several runs; default: the first")
    parser.add_argument(
        "--vary",
        action="append",
        default=[],
        metavar="NODE.PARAM=VALUES",
        help="x,y,z, lists as [x,y],[z], or FIRST:LAST:COUNT for so many numbers; may be repeated, then every value "
        "meets every other",
    )
    parser.add_argument("--seeds", type=int, default=1, metavar="N", help="runs of each, with the seeds 0 to N - 1")
    parser.add_argument("--metrics", default="", metavar="NAME,NAME", help="default: all that can be measured")


def variations(given: argparse.Namespace) -> dict[str, list[Any]]:
    """By NODE.PARAM, and `seed` if there are several, the values; ParameterError for words without sense."""
    varied: dict[str, list[Any]] = {}
    for word in given.vary:
        place, found, text = word.partition("=")
        if not (found and text and place.partition(".")[2]):
            raise ParameterError(f"--vary {quoted(word)} is refused, allowed is NODE.PARAM=x,y,z or =FIRST:LAST:COUNT")
        for other in (*varied, *(["*.seed"] if given.seeds > 1 else [])):
            if _is_same(place, other):
                raise ParameterError(f"--vary {quoted(word)} is refused: {other} varies already, allowed is once")
        varied[place] = _values(word, text)
        if not varied[place]:
            raise ParameterError(f"--vary {quoted(word)} is refused: it names no value, allowed is one or more")
    if given.seeds < 1:
        raise ParameterError(f"--seeds {given.seeds} is refused, allowed is 1 or more")
    return {**varied, **({SEED: list(range(given.seeds))} if given.seeds > 1 else {})}


def _is_same(place: str, other: str) -> bool:
    (node, _, name), (other_node, _, other_name) = place.partition("."), other.partition(".")
    return name == other_name and (node == other_node or "*" in (node, other_node))


def _values(word: str, text: str) -> list[Any]:
    if text.count(":") != 2 or "," in text:
        try:
            return read_yaml(f"[{text}]")
        except yaml.YAMLError:
            raise ParameterError(f"--vary {quoted(word)} is refused, allowed is x,y,z or [x,y],[z]") from None
    try:
        first, last, count = text.split(":")
        values = np.linspace(float(first), float(last), int(count)).tolist()
        is_whole = all(value.is_integer() for value in values)  # which parameters are that count
        return [int(value) for value in values] if is_whole else values
    except ValueError:
        raise ParameterError(f"--vary {quoted(word)} is refused, allowed is FIRST:LAST:COUNT of numbers") from None


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Every value with every other, the last one named changing first."""
    varied = variations(given)
    run = given.run or load_scenario(given.scenario).runs[0].name
    found = []
    for values in itertools.product(*varied.values()):
        named = dict(zip(varied, values, strict=True))
        places = [("*", SEED, value) if name == SEED else (*name.split(".", 1), value) for name, value in named.items()]
        name = ", ".join(f"{name}={_shown_value(value)}" for name, value in named.items())
        found.append(Case(name or given.scenario, given.scenario, tuple(places), run))
    return found


def _shown_value(value: Any) -> str:
    """A value with all digits that distinguish it from others."""
    return str(value).removesuffix(".0") if isinstance(value, float) else str(value)


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """Every metric of the scenario's report and of its file that can be measured, and its unit."""
    parameters = {role: configuration.values() for role, configuration in run.configurations.items()}
    runs = {run.name: recording}
    found = dict(report_for(run.report).metrics(runs, run.configurations[MASTER].common.vehicle, parameters))
    found |= own_metrics(run.metrics, runs)
    known = {name: metric for name, metric in found.items() if metric.value is not None}
    units = {name: metric.unit for name, metric in known.items()}
    return {**{name: metric.value for name, metric in known.items()}, "units": units}


def _shown(given: argparse.Namespace, results: Results) -> dict[str, str]:
    """By name the unit of the metrics that are shown; ParameterError for one that no run has measured."""
    units: dict[str, str] = {}
    for result in results.values():
        units |= result.measured.get("units", {})
    chosen = given.metrics.split(",") if given.metrics else list(units)
    for name in chosen:
        if name not in units:
            raise ParameterError(f"no run has measured a metric {quoted(name)}; measured: {', '.join(units) or 'none'}")
    return {name: units[name] for name in chosen}


def table(given: argparse.Namespace, results: Results) -> tuple[list[str], list[list[Any]]]:
    """Columns and rows: the values and the metrics of each run, None for what could not be measured."""
    varied, shown = variations(given), _shown(given, results)
    columns = [*varied, *(f"{name} [{unit}]" for name, unit in shown.items())]
    combined = zip(itertools.product(*varied.values()), results.values(), strict=True)
    return columns, [[*values, *(result.measured.get(name) for name in shown)] for values, result in combined]


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """The least and the largest of each metric over all runs."""
    found = {}
    for name, unit in _shown(given, results).items():
        values = [result.measured[name] for result in results.values() if name in result.measured]
        found |= {f"{name}_least": Metric(min(values), unit), f"{name}_largest": Metric(max(values), unit)}
    return found


def tables(given: argparse.Namespace, results: Results) -> str:
    """The rows as aligned text, and a line if there is no metric in them."""
    columns, rows = table(given, results)
    given_ones = len(variations(given))
    texts = [[*map(_shown_value, row[:given_ones]), *map(cell, row[given_ones:])] for row in rows]
    hint = "" if columns[given_ones:] else f"\n\nno metric was measured: scripts/run.sh {given.scenario} says why"
    return text_table(columns, texts, left=()) + hint


def figures(given: argparse.Namespace, results: Results) -> dict[str, Sheet]:
    """Over one varied number lines with bands of the seeds, over two maps of the means; nothing over more or texts."""
    varied = variations(given)
    seeds = len(varied.pop(SEED, [0]))
    axes = {name: np.array(values, float) for name, values in varied.items() if _are_numbers(values)}
    lengths = [len(values) for values in axes.values()]
    if len(axes) != len(varied) or len(axes) not in (1, 2) or min(lengths) < 2:
        return {}
    panels = []
    for name, unit in _shown(given, results).items():
        found = [result.measured.get(name) for result in results.values()]
        values = np.array([math.nan if value is None else value for value in found]).reshape(*lengths, seeds)
        shown, factor = IN_FIGURES.get(unit, (unit, 1.0))
        title, (*y, x) = readable(name), axes.items()
        panels.append(
            colour_map(title, x, y[0], shown, factor * values.mean(axis=2))
            if y
            else band(title, x, f"{title} [{shown}]", factor * values)
        )
    return {"sweep": Sheet(panels)}


def _are_numbers(values: Sequence[Any]) -> bool:
    return all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in values)
