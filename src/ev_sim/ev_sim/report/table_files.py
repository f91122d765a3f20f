"""A table as files for other tools and for papers: CSV, Markdown, LaTeX, and Parquet where pyarrow is installed."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from ev_sim.recording.atomic import atomic_file

NAME = "table"
TABLES = tuple(f"{NAME}.{kind}" for kind in ("csv", "md", "tex", "parquet"))
_SPECIAL = {"\\": r"\textbackslash{}", "_": r"\_", "%": r"\%", "&": r"\&", "#": r"\#", "$": r"\$", "^": r"\^{}"}


def write_tables(folder: Path, columns: Sequence[str], rows: Sequence[Sequence[Any]]) -> None:
    """Write table.csv with all digits of numbers, table.md, table.tex, and table.parquet; None is an empty cell."""
    for suffix, text in (("csv", _csv), ("md", _markdown), ("tex", _latex)):
        with atomic_file(folder / f"{NAME}.{suffix}") as file:
            file.write(text(columns, rows).encode())
    if find_spec("pyarrow") is not None:
        import pyarrow
        import pyarrow.parquet

        series = {column: _of_one_kind([row[i] for row in rows]) for i, column in enumerate(columns)}
        with atomic_file(folder / f"{NAME}.parquet") as file:
            pyarrow.parquet.write_table(pyarrow.table(series), file)


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


def _markdown(columns: Sequence[str], rows: Sequence[Sequence[Any]]) -> str:
    lines = [columns, ["---"] * len(columns), *([cell(value) for value in row] for row in rows)]
    return "".join(f"| {' | '.join(each.replace('|', '&#124;') for each in line)} |\n" for line in lines)


def _latex(columns: Sequence[str], rows: Sequence[Sequence[Any]]) -> str:
    def line(cells: Sequence[Any], text: Callable[[Any], str]) -> str:
        return " & ".join("".join(_SPECIAL.get(c, c) for c in text(each)) for each in cells) + r" \\" + "\n"

    body = "".join(line(row, cell) for row in rows)
    head = f"\\begin{{tabular}}{{{'l' * len(columns)}}}\n\\hline\n{line(columns, str)}\\hline\n"
    return f"{head}{body}\\hline\n\\end{{tabular}}\n"
