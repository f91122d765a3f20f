"""Tables of metrics on the terminal, in a notebook, and as files for other tools.

Files are CSV, Markdown, LaTeX, and Parquet where pyarrow is installed.
"""

from __future__ import annotations

import base64
import csv
import io
import math
import shutil
import sys
import textwrap
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from importlib.util import find_spec
from pathlib import Path
from types import MappingProxyType
from typing import Any, TextIO

from ev_stack.figures.panels import IN_FIGURES
from ev_stack.figures.sheets import Figure
from ev_stack.measures.metric import Metric, condition
from ev_stack.recording.recording import atomic_file
from ev_stack.report.latex import DIGITS, latex_table

METRIC_COLUMNS = ("metric", "value", "unit", "reference", "band", "verdict")
NARROW = (
    ("metric", "value", "unit", "reference", "verdict"),
    ("metric", "value", "unit", "verdict"),
)
WIDTH_OF_A_PIPE = 120
_TEXT = ("metric", "unit", "band", "verdict")
_SHOWN = 12  # metrics, where a line of Python shows a result


def write_tables(
    folder: Path,
    columns: Sequence[str],
    rows: Sequence[Sequence[Any]],
    digits: int = DIGITS,
    best: Mapping[str, str] = MappingProxyType({}),
) -> None:
    """Write table.csv with all digits, table.md, table.tex, and table.parquet.

    None is an empty cell.

    `digits` and `best` are those of `latex_table`.
    """
    texts = {
        "csv": _csv(columns, rows),
        "md": markdown_table(columns, rows),
        "tex": latex_table(columns, rows, digits, best),
    }
    for suffix, text in texts.items():
        with atomic_file(folder / f"table.{suffix}") as file:
            file.write(text.encode())
    write_parquet(
        folder / "table.parquet", {name: [row[i] for row in rows] for i, name in enumerate(columns)}
    )


def write_parquet(path: Path, columns: Mapping[str, Sequence[Any]]) -> None:
    """Write columns of one length as a Parquet file, where pyarrow is installed; None is a gap."""
    if find_spec("pyarrow") is not None:
        import pyarrow
        import pyarrow.parquet

        table = pyarrow.table({name: _of_one_kind(values) for name, values in columns.items()})
        with atomic_file(path) as file:
            pyarrow.parquet.write_table(table, file)


def _of_one_kind(values: Sequence[Any]) -> Sequence[Any]:
    """A column as Parquet takes it: what is not all of numbers is text."""
    if all(value is None or isinstance(value, int | float) for value in values):
        return values
    return [None if value is None else str(value) for value in values]


def cell(value: Any) -> str:
    """A value as a reader wants it, numbers with six digits."""
    if value is None:
        return "-"
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _csv(columns: Sequence[str], rows: Sequence[Sequence[Any]]) -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([columns, *rows])
    return text.getvalue()


def markdown_table(columns: Sequence[str], rows: Sequence[Sequence[Any]]) -> str:
    """A table in Markdown; bars in cells are escaped."""
    lines = [columns, ["---"] * len(columns), *([cell(value) for value in row] for row in rows)]
    return "".join(
        f"| {' | '.join(each.replace('|', '&#124;') for each in line)} |\n" for line in lines
    )


def text_table(columns: Sequence[str], rows: Sequence[Sequence[str]], left: Collection[str]) -> str:
    """Lay out a table with a line below its head; columns in `left` are set to the left."""
    widths = [max(len(row[i]) for row in (columns, *rows)) for i in range(len(columns))]
    sides = [str.ljust if column in left else str.rjust for column in columns]
    lines = [columns, ["-" * width for width in widths], *rows]
    return "\n".join(
        "  ".join(
            side(cell, width) for side, cell, width in zip(sides, line, widths, strict=True)
        ).rstrip()
        for line in lines
    )


def tables_by_width(
    columns: Sequence[str], rows: Sequence[Sequence[str]], kept: int, left: Collection[str]
) -> str:
    """Lay out a table, in a narrow terminal as several, each with the first `kept` columns."""
    widths = [2 + max(len(row[i]) for row in (columns, *rows)) for i in range(len(columns))]
    # Each column counts with the two blanks behind it; the last one has none.
    room = _terminal_width() + 2 - sum(widths[:kept])
    parts: list[list[int]] = [[]]
    for i in range(kept, len(columns)):
        # A column that is too wide even alone gets a table of its own all the same.
        if parts[-1] and sum(widths[j] for j in (*parts[-1], i)) > room:
            parts.append([])
        parts[-1].append(i)
    chosen = [[*range(kept), *part] for part in parts]
    return "\n\n".join(
        text_table([columns[i] for i in c], [[row[i] for i in c] for row in rows], left)
        for c in chosen
    )


@dataclass(frozen=True)
class Table:
    """Columns and rows, of which the first `left` columns name a row and stand to the left.

    `better` has by column which values are better, LOWER or HIGHER.
    """

    columns: Sequence[str]
    rows: Sequence[Sequence[Any]]
    left: int = 1
    better: Mapping[str, str] = field(default_factory=dict)

    def text(self) -> str:
        """Return it for the terminal, from rows of texts."""
        return text_table(self.columns, self.rows, self.columns[: self.left])


def print_metrics(metrics: Mapping[str, Metric], file: TextIO | None = None) -> None:
    """Print the metrics; a narrow terminal omits bands, angles in degrees and references."""
    print(metric_table(metrics, _terminal_width()), file=file or sys.stdout)


def _terminal_width() -> int:
    return shutil.get_terminal_size((WIDTH_OF_A_PIPE, 24)).columns


def metric_table(metrics: Mapping[str, Metric], width: int = WIDTH_OF_A_PIPE) -> str:
    """Name, value, unit, reference, band and verdict of each metric in aligned columns.

    Angles stand in rad with deg beside. Assumptions and reasons are numbered and follow below the
    table.
    """
    notes: list[str] = []
    rows = [_row(name, metric, notes) for name, metric in metrics.items()]
    lines = _lines(METRIC_COLUMNS, rows)
    without_degrees = [{**row, "value": row["value in rad"]} for row in rows]
    # First without bands and degrees, then without references, as far as it is needed.
    for columns in NARROW:
        if max(map(len, lines)) > width:
            lines = _lines(columns, without_degrees)
    for number, note in enumerate(notes, start=1):
        indent = f"[{number}] "
        lines += textwrap.wrap(
            note, max(width, 40), initial_indent=indent, subsequent_indent=" " * len(indent)
        )
    return "\n".join(lines)


def short_lines(metrics: Mapping[str, Metric]) -> list[str]:
    """A line for each of the first metrics that have a value, and how many more there are."""
    lines = [
        f"{name} = {each.in_words or _with_unit(each.value, each.unit)}, {each.judgement}"
        for name, each in metrics.items()
        if each.value is not None
    ]
    more = len(metrics) - len(lines[:_SHOWN])
    return [*lines[:_SHOWN], *([f"and {more} more in .metrics"] if more else [])]


def _with_unit(value: float, unit: str) -> str:
    """A number with its unit, none of a pure number, and an angle also in degrees."""
    if unit == "1":
        return cell(value)
    other, factor = IN_FIGURES.get(unit, (unit, 1.0))
    beside = "" if factor == 1.0 else f" ({factor * value:.4g} {other})"
    return f"{cell(value)} {unit}{beside}"


def _lines(columns: tuple[str, ...], rows: list[dict[str, str]]) -> list[str]:
    return text_table(
        columns, [[row[column] for column in columns] for row in rows], left=_TEXT
    ).splitlines()


def _row(name: str, metric: Metric, notes: list[str]) -> dict[str, str]:
    reference = metric.reference
    value = metric.in_words or _number(metric.value)
    published = ""
    if reference:
        published = condition(reference.value, metric.formula) or _number(reference.value)
    if metric.standard_deviation is not None:
        value += f" ± {metric.standard_deviation:.2g}"
    return {
        "metric": name,
        "value": (
            f"{value} ({math.degrees(metric.value):.2f} deg)"
            if metric.unit == "rad" and metric.value
            else value
        ),
        "value in rad": value,
        "unit": "" if metric.in_words else metric.unit,
        "reference": published or "-",
        "band": (
            " .. ".join(_number(end) if math.isfinite(end) else "" for end in reference.band)
            if reference
            else "-"
        ),
        "verdict": _judgement(metric, notes),
    }


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.5g}"


def _judgement(metric: Metric, notes: list[str]) -> str:
    """The judgement, with the number of the note that completes it."""
    if not metric.note:
        return metric.judgement
    note = f"assumption: {metric.note}" if metric.judgement == "reproduced" else metric.note
    # A note that several metrics share stands below the table once.
    if note not in notes:
        notes.append(note)
    return f"{metric.judgement} [{notes.index(note) + 1}]"


def html_of(text: str, figures: Mapping[str, Figure]) -> str:
    """A piece of HTML that needs nothing else."""
    table = f"<pre>{escape(text)}</pre>"
    images = []
    for name, figure in figures.items():
        png = base64.b64encode(figure.png()).decode()
        images.append(f'<img alt="{escape(name)}" src="data:image/png;base64,{png}">')
    return "".join([table, *images])


def quantile(histogram: Mapping[str, Any], share: float) -> float:
    """Smallest end of a bin [s] below which at least this share lies, or the largest time."""
    # The bins in order, until they hold the share that is due.
    due, seen = share * sum(histogram["counts"]), 0
    # Not strict: the last bin has no upper edge, and its end is the largest time.
    for count, end in zip(histogram["counts"], histogram["edges"], strict=False):
        seen += count
        if seen >= due:
            return float(min(end, histogram["largest"]))
    return float(histogram["largest"])


def in_words(timing: Mapping[str, Any]) -> str:
    """One line: late steps, lateness, and commands that were missed."""
    late = timing["lateness"]
    middle, most, largest = (
        1e3 * time for time in (quantile(late, 0.5), quantile(late, 0.99), late["largest"])
    )
    return (
        f"real time: {timing['overruns']} of {timing['steps']} steps came more than a period late;"
        f" lateness at most {middle:.3g} ms of half of them, {most:.3g} ms of 99 %, {largest:.3g}"
        f" ms of all; {timing['without_command']} steps with less torque since the command was"
        " too old"
    )
