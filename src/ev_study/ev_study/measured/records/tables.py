"""Columns of CSV files, packed or not.

How it works: the file is read row by row into blocks of numbers, since a log of an hour would take
many times its size as texts. A cell that is no number becomes NaN. Empty cells and words such as
"n/a" are expected; other texts are counted, and the first of them is named.
"""

from __future__ import annotations

import csv
import hashlib
import io
import lzma
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ev_core.parameters.data_file import MEGABYTE, SIGNALS, read_data
from ev_msgs_py.refusal import ParameterError, quoted

_AT_ONCE = 10_000  # rows that are held as texts
# in lower case: a cell without a number
_MISSING = ("", "-", "na", "n/a", "#n/a", "null", "none", "nan")


class Table(NamedTuple):
    """Columns by name, SHA-256 of the file, units by name if it has a row of them, and by name texts in the cells.

    A cell that is no number is NaN.
    """

    columns: dict[str, np.ndarray]
    digest: str
    units: Mapping[str, str]
    texts: Mapping[str, str]


def read_columns(path: Path) -> Table:
    """The table of a CSV file.

    .csv.xz is unpacked. ParameterError, in one line, if it is none or is cut off.

    The first line that is not empty is the header, with or without "#" before it. Columns are
    separated by commas, or by semicolons or tabs, beside which a comma is that of a decimal. A
    first row without any number is one of units.
    """
    try:
        content = read_data(path, SIGNALS)
        # The digest below is of the file as it is, packed.
        text = _unpacked(content) if path.suffix == ".xz" else content
        # utf-8-sig: spreadsheets write a mark at the begin that would become part of the first
        # name.
        lines = io.StringIO(text.decode("utf-8-sig"), newline="")
        above, header = next(
            ((n, line) for n, line in enumerate(lines, 1) if line.strip()), (0, "")
        )
        header = header.lstrip("# ")
        # A comma is last, since with another separator it is that of the decimals.
        separator = next((each for each in ";\t" if each in header), ",")
        names = [cell.strip() for cell in next(csv.reader([header], delimiter=separator), [])]
        if len(set(names)) < len(names):
            raise ParameterError(f"{path}: the header has a name twice, expected is each once")
        units, rows, texts = _numbers(path, above, lines, names, separator)
    except OSError as error:
        raise ParameterError(f"{path}: {error.strerror or error}") from None
    except (EOFError, lzma.LZMAError, ValueError, csv.Error) as error:
        # It is a ValueError as well, and has its line already.
        if isinstance(error, ParameterError):
            raise
        reason = " ".join(str(error).split())[:200]
        raise ParameterError(
            f"{path} is no CSV table of at most {SIGNALS // MEGABYTE} MB: {reason}"
        ) from None
    return Table(
        dict(zip(names, rows.T, strict=True)), hashlib.sha256(content).hexdigest(), units, texts
    )


def _unpacked(content: bytes) -> bytes:
    """All streams of an .xz file.

    Raises EOFError if the last one has no end, ValueError if they are too large.
    """
    with lzma.open(io.BytesIO(content)) as file:
        # One byte more than is allowed shows that there is more; a small file may unfold to any
        # size.
        text = file.read(SIGNALS + 1)
    if len(text) > SIGNALS:
        raise ValueError("it unpacks to more")
    return text


def _numbers(
    path: Path, above: int, lines: io.StringIO, names: list[str], separator: str
) -> tuple[dict[str, str], np.ndarray, dict[str, str]]:
    """Units, rows (n, columns), and by column how many cells are texts, with the first of them.

    `above` is the number of lines up to the header.
    """
    reader = csv.reader(lines, delimiter=separator)
    units: dict[str, str] = {}
    first: dict[str, str] = {}
    count: dict[str, int] = {}
    blocks: list[np.ndarray] = [np.empty((0, len(names)))]
    block: list[list[float]] = []
    begun = False
    for row in reader:
        if not any(cell.strip() for cell in row) or row[0].lstrip().startswith("#"):
            continue
        line = above + reader.line_num
        if len(row) != len(names):
            raise ParameterError(
                f"{path}: line {line} has {len(row)} cells, expected {len(names)}, as the"
                " header has"
            )
        cells = [cell.replace(",", ".") for cell in row] if separator != "," else row
        values = _values(cells)
        if not begun:
            begun = True
            # Only the first row can be one of units; an empty one is data that had not begun.
            if all(value is None for value in values) and not all(
                _is_missing(cell) for cell in row
            ):
                units = {
                    name: cell.strip().strip("[]()") for name, cell in zip(names, row, strict=True)
                }
                continue
        for name, cell, value in zip(names, row, values, strict=True):
            if value is None and not _is_missing(cell):
                first.setdefault(name, f"{quoted(cell.strip())} in line {line}")
                count[name] = count.get(name, 0) + 1
        block.append([np.nan if value is None else value for value in values])
        if len(block) == _AT_ONCE:
            blocks.append(np.array(block))
            block = []
    if block:
        blocks.append(np.array(block))
    texts = {name: f"{count[name]} cells are no numbers, such as {first[name]}" for name in first}
    return units, np.concatenate(blocks), texts


def _values(cells: list[str]) -> list[float | None]:
    """The numbers of a row, None for a cell that is none."""
    try:
        # The whole row at once; cell by cell only where one of them is no number.
        return [float(cell) for cell in cells]
    except ValueError:
        return [_number(cell) for cell in cells]


def _number(cell: str) -> float | None:
    try:
        return float(cell)
    except ValueError:
        return None


def _is_missing(cell: str) -> bool:
    return cell.strip().lower() in _MISSING
