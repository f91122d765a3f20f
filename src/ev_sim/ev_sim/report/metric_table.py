"""The table of metrics as plain text."""

from __future__ import annotations

import math
import shutil
import sys
import textwrap
from collections.abc import Mapping
from typing import TextIO

from ev_sim.report.metric import Metric
from ev_sim.report.text_table import text_table

COLUMNS = ("metric", "value", "unit", "reference", "band", "verdict")
NARROW = (("metric", "value", "unit", "reference", "verdict"), ("metric", "value", "unit", "verdict"))
WIDTH_OF_A_PIPE = 120
_TEXT = ("metric", "unit", "band", "verdict")


def print_metrics(metrics: Mapping[str, Metric], file: TextIO | None = None) -> None:
    """Print the table of metrics, in a narrow terminal without bands, angles in degrees and references."""
    width = shutil.get_terminal_size((WIDTH_OF_A_PIPE, 24)).columns
    print(metric_table(metrics, width), file=file or sys.stdout)


def metric_table(metrics: Mapping[str, Metric], width: int = WIDTH_OF_A_PIPE) -> str:
    """Name, value, unit, reference, band and verdict of each metric in aligned columns.

    Angles stand in rad with deg beside. Assumptions and reasons are numbered and follow below the table.
    """
    notes: list[str] = []
    rows = [_row(name, metric, notes) for name, metric in metrics.items()]
    lines = _lines(COLUMNS, rows)
    without_degrees = [{**row, "value": row["value in rad"]} for row in rows]
    for columns in NARROW:
        if max(map(len, lines)) > width:
            lines = _lines(columns, without_degrees)
    for number, note in enumerate(notes, start=1):
        indent = f"[{number}] "
        lines += textwrap.wrap(note, max(width, 40), initial_indent=indent, subsequent_indent=" " * len(indent))
    return "\n".join(lines)


def _lines(columns: tuple[str, ...], rows: list[dict[str, str]]) -> list[str]:
    return text_table(columns, [[row[column] for column in columns] for row in rows], left=_TEXT).splitlines()


def _row(name: str, metric: Metric, notes: list[str]) -> dict[str, str]:
    reference = metric.reference
    value = _number(metric.value)
    if metric.standard_deviation is not None:
        value += f" ± {metric.standard_deviation:.2g}"
    return {
        "metric": name,
        "value": f"{value} ({math.degrees(metric.value):.2f} deg)" if metric.unit == "rad" and metric.value else value,
        "value in rad": value,
        "unit": metric.unit,
        "reference": _number(reference.value) if reference else "-",
        "band": " .. ".join(_number(end) if math.isfinite(end) else "" for end in reference.band) if reference else "-",
        "verdict": _judgement(metric, notes),
    }


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.5g}"


def _judgement(metric: Metric, notes: list[str]) -> str:
    """The judgement, with the number of the note that completes it."""
    if not metric.note:
        return metric.judgement
    note = f"assumption: {metric.note}" if metric.judgement == "reproduced" else metric.note
    if note not in notes:
        notes.append(note)
    return f"{metric.judgement} [{notes.index(note) + 1}]"
