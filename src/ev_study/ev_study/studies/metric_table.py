"""Metrics of runs by name as a table: a row for each run, a column for each metric that is shown."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from ev_stack.measures.own_metrics import named_metric
from ev_stack.report.tables import Table
from ev_study.studies.study import CaseResult, Results

Units = Mapping[str, str]  # of the shown metrics, by name


def values_of(result: CaseResult) -> Mapping[str, float]:
    """Metrics of a run that have a value, by name; none of one that was refused."""
    return result.measured.get("metrics", {})


def shown_metrics(texts: Sequence[str], results: Results) -> Units:
    """Return the metrics that are asked for, or without any all that some run has a value of."""
    units: dict[str, str] = {}
    known = set[str]()
    for result in results.values():
        units |= result.measured.get("units", {})
        known.update(values_of(result))
    if not texts:
        return {name: unit for name, unit in units.items() if name in known}
    names = [text if text in units else named_metric(text).name for text in texts]
    return {name: units.get(name, "") for name in names}


def metric_table(
    heads: Sequence[str], called: Iterable[tuple[Sequence[Any], CaseResult]], shown: Units
) -> Table:
    """Return a row for each result: what it is called by below `heads`, then its metrics.

    None stands for what was not measured.
    """
    rows = []
    ways: dict[str, str] = {}
    for names, result in called:
        values = values_of(result)
        rows.append([*names, *(values.get(name) for name in shown)])
        ways |= result.measured.get("better", {})
    columns = {name: f"{name} [{unit}]" for name, unit in shown.items()}
    better = {column: ways[name] for name, column in columns.items() if name in ways}
    return Table([*heads, *columns.values()], rows, len(heads), better)


def not_measured(names: Iterable[str], results: Results) -> str:
    """Return a line for each metric that no run has, with the reason of one; empty without any."""
    found = []
    for name in names:
        reasons = [
            result.measured["reasons"].get(name) for result in results.values() if result.measured
        ]
        if reasons and all(reasons):
            found.append(f"not measured: {name}: {reasons[0]}")
    return "\n".join(found)
