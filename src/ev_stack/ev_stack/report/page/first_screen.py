"""First screen of a page: the curves of the manoeuvre and the metrics that judge it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import degrees
from typing import Any

import numpy as np

from ev_stack.measures.derived import SERIES
from ev_stack.measures.metric import NOT_REPRODUCED, NotMeasured, condition
from ev_stack.measures.motion import sideslip_in_motion
from ev_stack.measures.named import DrivenRun
from ev_stack.recording.recording import Recording
from ev_stack.report.page.plot_groups import NO_TOPIC, words
from ev_stack.scenarios.curves import DEFAULT, MOST
from ev_stack.views.car import PREFIX

SHOWN = 12  # rows of metrics
_NO_RUN = ""
_AT_REST = "sideslip_angle"  # has no meaning while the car stands


def series_channels(run: Recording, names: Iterable[str]) -> dict[str, np.ndarray]:
    """Compute the derived series of these names, (n,), as far as their channels are recorded."""
    found = {}
    for name in names:
        if name not in SERIES:
            continue
        try:
            # No series depends on the car.
            of_run = SERIES[name].of(DrivenRun(run, None))
            found[PREFIX + name] = sideslip_in_motion(run) if name == _AT_REST else of_run
        except NotMeasured:
            continue
    return found


def curve_plots(names: Sequence[str], groups: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Plots of the first screen: those of the names, else the usual ones, else the first ones."""
    plots = [
        {**plot, "title": f"{_topic_of(group)}{plot['title']}"}
        for group in groups
        for plot in group["plots"]
    ]
    usual = [plot for name in DEFAULT if (plot := _plot(name, plots))["curves"]]
    shown = [_plot(name, plots) for name in names] or usual or plots[:MOST]
    return [_in_degrees(plot) if plot["unit"] == "rad" else plot for plot in shown]


def _in_degrees(plot: Mapping[str, Any]) -> dict[str, Any]:
    """The plot with the unit of the metrics beside it; the page multiplies its samples."""
    return {**plot, "unit": "deg", "factor": degrees(1.0)}


def _topic_of(group: Mapping[str, Any]) -> str:
    """The topic of a group, in front of the titles of its plots; nothing for what has none."""
    if group["title"] == NO_TOPIC:
        return ""
    # Every second topic is a state of something.
    name = words(group["title"].replace("/", " ")).removesuffix(" state").removesuffix(" states")
    return f"{name}: "


def _plot(name: str, plots: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """The plot of a curve; without curves if it is not recorded."""
    if name in SERIES:
        curve = {"channel": PREFIX + name, "label": ""}
        return {"title": words(name), "unit": SERIES[name].unit, "about": "", "curves": [curve]}
    for plot in plots:
        channels = [curve["channel"] for curve in plot["curves"]]
        if name in channels and len(channels) > 1:
            curve = plot["curves"][channels.index(name)]
            title = f"{plot['title']} {curve['label']}"
            return {**plot, "title": title, "curves": [{**curve, "label": ""}]}
        if channels[0] == name or channels[0].startswith(f"{name}."):
            return dict(plot)
    return {"title": words(name), "unit": "", "about": "", "curves": []}


@dataclass(frozen=True, slots=True)
class Cell:
    """A value in words with its unit, and its verdict if it failed."""

    text: str
    failed: str = ""


@dataclass(frozen=True)
class Judged:
    """The metrics of the first screen: a row for each name, a cell for each column or for all.

    Those that failed come first, then those with a reference. `failed` counts verdicts.
    """

    columns: Sequence[str] = ()
    rows: Sequence[tuple[str, Sequence[Cell | None]]] = ()
    failed: int = 0


def judged(summaries: Mapping[str, Mapping[str, Any]]) -> Judged:
    """Order the metrics of the results; of one result with several runs, a column for each run."""
    found: dict[str, dict[str, Mapping[str, Any]]] = {}
    columns = list(summaries)
    runs: list[str] = []
    if len(summaries) == 1:
        (summary,) = summaries.values()
        runs = list(summary.get("runs") or summary.get("cases") or ())
    for label, summary in summaries.items():
        metrics = summary.get("metrics", {})
        places = _of_runs(metrics, runs) if len(runs) > 1 else {}
        for name, metric in metrics.items():
            column, base = places.get(name, (label, name))
            found.setdefault(base, {})[column] = metric
    if len(runs) > 1:
        # In the order of the metrics, which is that of the scenario.
        columns = [name for name in dict.fromkeys(c for of in found.values() for c in of) if name]
    ordered = sorted(found.items(), key=lambda item: _rank(item[1].values()))
    rows = [(name, _cells(of, columns)) for name, of in ordered]
    failed = sum(bool(cell and cell.failed) for _, cells in rows for cell in cells)
    return Judged(columns, rows, failed)


def _cells(of: Mapping[str, Mapping[str, Any]], columns: Sequence[str]) -> list[Cell | None]:
    """A cell for each column; a single one for what belongs to no run, as a difference of two."""
    if _NO_RUN in of and _NO_RUN not in columns:
        return [_cell(of[_NO_RUN])]
    return [_cell(of[column]) if column in of else None for column in columns]


def _of_runs(names: Iterable[str], runs: Iterable[str]) -> dict[str, tuple[str, str]]:
    """The run of each metric and its name without it; no run and the whole name for others."""
    split = {name: _split(name, runs) for name in names}
    of_base: dict[str, list[str]] = {}
    for run, base in split.values():
        of_base.setdefault(base, []).append(run)
    places = {}
    for name, (run, base) in split.items():
        # What looks like a metric of one run alone has a name of its own, as
        # `left_right_difference` of the runs left and right; and no two metrics have one place.
        found = of_base[base]
        is_of_run = len(found) > 1 and len(set(found)) == len(found)
        places[name] = (run, base) if is_of_run else (_NO_RUN, name)
    return places


def _split(name: str, runs: Iterable[str]) -> tuple[str, str]:
    """The run that a name begins or ends with, and the rest of it."""
    # The longest first: one name may begin with another.
    for run in sorted(runs, key=len, reverse=True):
        if name.startswith(f"{run}_"):
            return run, name.removeprefix(f"{run}_")
        if name.endswith(f"_{run}"):
            return run, name.removesuffix(f"_{run}")
    return _NO_RUN, name


def _rank(metrics: Iterable[Mapping[str, Any]]) -> int:
    """0 if one failed, 1 if one has a reference, else 2; a stable sort keeps the rest in order."""
    metrics = list(metrics)
    if any(has_failed(metric["verdict"]) for metric in metrics):
        return 0
    return 1 if any(metric["reference"] is not None for metric in metrics) else 2


def has_failed(verdict: str) -> bool:
    """True for a verdict against a published value."""
    return verdict.startswith(NOT_REPRODUCED)


def _cell(metric: Mapping[str, Any]) -> Cell:
    value, unit, verdict = metric["value"], metric["unit"], metric["verdict"]
    failed = NOT_REPRODUCED if has_failed(verdict) else ""
    if value is None:
        return Cell("–", failed)
    if answer := condition(value, metric.get("formula", "")):
        return Cell(answer, failed)
    if unit == "rad":
        return Cell(f"{degrees(value):.4g} deg", failed)
    return Cell(f"{value:.4g}" if unit == "1" else f"{value:.4g} {unit}", failed)
