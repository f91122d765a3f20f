"""Any parameters of any scenario over values and seeds: a row of metrics for each run, as table and figures.

How it works: the values of --vary and the seeds are combined, the last one named changing first.
Each combination is a case of the scenario with its own report, so a row has the metrics of that
report and those that are asked for.
"""

from __future__ import annotations

import argparse
import itertools
import math
import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import yaml

from ev_msgs_py.refusal import ParameterError, quoted
from ev_stack.command_line.options import add_metrics
from ev_stack.figures.other_axes import band, colour_map, mean_of_seeds
from ev_stack.figures.panels import IN_FIGURES, readable
from ev_stack.figures.sheets import Sheet
from ev_stack.measures.metric import Metric
from ev_stack.measures.own_metrics import listed
from ev_stack.recording.recording import Recording
from ev_stack.report.reports import further_metrics, measured_metrics, row_of
from ev_stack.report.tables import Table, cell, tables_by_width
from ev_stack.scenarios.parameter_file import read_yaml
from ev_stack.scenarios.records import Run
from ev_study.studies.metric_table import (
    Units,
    metric_table,
    not_measured,
    shown_metrics,
    values_of,
)
from ev_study.studies.study import Case, Results, run_of_command

ABOUT = (
    "Any parameters of any scenario over values and seeds - a row for each run, lines with bands or"
    " maps"
)
SEED = "seed"
MOST = 100_000  # runs of a sweep


def add_options(parser: argparse.ArgumentParser) -> None:
    """Options for the scenario, what varies, and what is shown of it."""
    parser.add_argument(
        "scenario",
        nargs="?",
        default="double_lane_change",
        help="name or path; default: %(default)s",
    )
    parser.add_argument(
        "--run", default="", help="of a scenario with several runs; default: the first"
    )
    parser.add_argument(
        "--vary",
        action="append",
        default=[],
        metavar="NODE.PARAM=VALUES",
        help=(
            "x,y,z, lists as [x,y],[z], or FIRST:LAST:COUNT for so many numbers; may be repeated,"
            " then every value meets every other"
        ),
    )
    parser.add_argument(
        "--seeds", type=int, default=1, metavar="N", help="runs of each, with the seeds 0 to N - 1"
    )
    add_metrics(parser, "default: those of the scenario")


def variations(given: argparse.Namespace) -> dict[str, list[Any]]:
    """Values by NODE.PARAM, and by `seed` if there are several.

    Raises ParameterError for words without sense.
    """
    if not 1 <= given.seeds <= MOST:
        raise ParameterError(f"--seeds {given.seeds} is refused, expected 1 to {MOST}")
    varied: dict[str, list[Any]] = {}
    for word in given.vary:
        place, found, text = word.partition("=")
        if not (found and text and place.partition(".")[2]):
            raise ParameterError(
                f"--vary {quoted(word)} is refused, expected NODE.PARAM=x,y,z or =FIRST:LAST:COUNT"
            )
        for other in (*varied, *(["*.seed"] if given.seeds > 1 else [])):
            if _is_same(place, other):
                raise ParameterError(
                    f"--vary {quoted(word)} is refused: {other} varies already, expected once"
                )
        try:
            varied[place] = _values(text)
        except ValueError as why:
            raise ParameterError(f"--vary {quoted(word)} is refused, expected {why}") from None
    # Before the product is made: 100 000 combinations are fine, a typing error may mean billions.
    runs = given.seeds * math.prod(map(len, varied.values()))
    if runs > MOST:
        raise ParameterError(
            f"a sweep of {runs} runs is refused, expected at most {MOST}; docs/batch.md has what"
            " drives more"
        )
    if runs == 1 and not varied:
        raise ParameterError(
            "a sweep of nothing is refused, expected --vary NODE.PARAM=x,y,z, --seeds N, or both"
        )
    return {**varied, **({SEED: list(range(given.seeds))} if given.seeds > 1 else {})}


def _is_same(place: str, other: str) -> bool:
    (node, _, name), (other_node, _, other_name) = place.partition("."), other.partition(".")
    return name == other_name and (node == other_node or "*" in (node, other_node))


def _values(text: str) -> list[Any]:
    """The values that a text lists or spans; ValueError with what is expected."""
    numbers = r"\s*[-+.\deE]+\s*"
    # Numbers with colons are a span, even one with a mistake: as YAML they would be a text.
    if (text.count(":") == 2 and "," not in text) or re.fullmatch(
        rf"{numbers}(:{numbers})+:?", text
    ):
        return _spanned(text)
    try:
        values: list[Any] = read_yaml(f"[{text}]")
    except yaml.YAMLError:
        raise ValueError("x,y,z or [x,y],[z]") from None
    if not values:
        raise ValueError("one value or more")
    return values


def _spanned(text: str) -> list[Any]:
    try:
        first, last, count = text.split(":")
        start, end, number = float(first), float(last), int(count)
    except ValueError:
        raise ValueError("FIRST:LAST:COUNT of numbers, such as 0:10:11 for 11 of them") from None
    if not (math.isfinite(start) and math.isfinite(end)):
        raise ValueError("FIRST:LAST:COUNT of finite numbers")
    if not (1 if start == end else 2) <= number <= MOST:
        raise ValueError(f"a COUNT from 2 to {MOST} in FIRST:LAST:COUNT")
    values = np.linspace(start, end, number).tolist()
    is_whole = all(value.is_integer() for value in values)  # which parameters are that count
    return [int(value) for value in values] if is_whole else values


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Every value with every other, the last one named changing first."""
    varied = variations(given)
    run = run_of_command(given)
    has_methods = not any(name.endswith(".method") for name in varied)
    metrics = further_metrics(run, listed(given.metrics), has_methods)
    found = []
    for values in itertools.product(*varied.values()):
        named = dict(zip(varied, values, strict=True))
        # A seed is that of all nodes.
        places = [
            ("*", SEED, value) if name == SEED else (*name.split(".", 1), value)
            for name, value in named.items()
        ]
        name = ", ".join(f"{name}={_shown_value(value)}" for name, value in named.items())
        found.append(Case(name, given.scenario, tuple(places), run.name, metrics=metrics))
    return found


def _shown_value(value: Any) -> str:
    """A value with all digits that distinguish it from others."""
    return str(value).removesuffix(".0") if isinstance(value, float) else str(value)


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """Every metric of the scenario's report, of its file and of the command line, with units and what is lacking."""
    return row_of(measured_metrics(recording, run))


def _shown(given: argparse.Namespace, results: Results) -> Units:
    return shown_metrics(listed(given.metrics), results)


def table(given: argparse.Namespace, results: Results) -> Table:
    """The varied values and the metrics of each run."""
    varied = variations(given)
    called = zip(itertools.product(*varied.values()), results.values(), strict=True)
    return metric_table(list(varied), called, _shown(given, results))


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """The least and the largest of each metric over all runs."""
    found = {}
    for name, unit in _shown(given, results).items():
        values = [of[name] for of in map(values_of, results.values()) if name in of]
        if values:
            found[f"{name}_least"] = Metric(min(values), unit)
            found[f"{name}_largest"] = Metric(max(values), unit)
    return found


def tables(given: argparse.Namespace, results: Results) -> str:
    """Rows as aligned text, and a line for each metric that no run has, or if there is none."""
    found = table(given, results)
    heads = found.left
    texts = [[*map(_shown_value, row[:heads]), *map(cell, row[heads:])] for row in found.rows]
    parts = [tables_by_width(found.columns, texts, heads, left=())]
    parts.append(not_measured(_shown(given, results), results))
    if not found.columns[heads:]:
        parts.append(f"\nno metric was measured: scripts/run.sh {given.scenario} says why")
    parts.append(_alike(results))
    return "\n".join(filter(None, parts))


def _alike(results: Results) -> str:
    """A note where runs have the same signals, as where a value is rounded inside.

    Empty if all differ.
    """
    hashes = [result.signal_hash for result in results.values() if result.signal_hash]
    if len(set(hashes)) == len(hashes):
        return ""
    return (
        f"note: {len(set(hashes))} different runs among {len(hashes)}: the others have the signals"
        " of one of these, since a value is rounded (docs/parameters.md), or acts on nothing here"
    )


def figures(given: argparse.Namespace, results: Results) -> dict[str, Sheet]:
    """Over one varied number lines with bands of the seeds, over two maps of the means.

    Nothing over more or texts.
    """
    varied = variations(given)
    seeds = len(varied.pop(SEED, [0]))
    axes = {
        name: np.array(values, float) for name, values in varied.items() if _are_numbers(values)
    }
    lengths = [len(values) for values in axes.values()]
    # Only numbers have an axis; more than two have no figure.
    if len(axes) != len(varied) or len(axes) not in (1, 2) or min(lengths) < 2:
        return {}
    panels = []
    for name, unit in _shown(given, results).items():
        values = np.array([values_of(result).get(name, math.nan) for result in results.values()])
        # In the order of `cases`: the seed changes fastest, since it is last in `variations`.
        values = values.reshape(*lengths, seeds)
        shown, factor = IN_FIGURES.get(unit, (unit, 1.0))
        title = readable(name)
        *y, x = axes.items()
        if y:
            # A map has no room for bands: seeds are averaged.
            means = factor * mean_of_seeds(values)
            panels.append(colour_map(title, x, y[0], shown, means))
        else:
            panels.append(band(title, x, f"{title} [{shown}]", factor * values))
    return {"sweep": Sheet(panels)}


def _are_numbers(values: Sequence[Any]) -> bool:
    return all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in values)
