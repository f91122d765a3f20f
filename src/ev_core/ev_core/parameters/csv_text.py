"""The numbers in the columns of a table in CSV."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Collection, Iterator, Mapping

from ev_msgs_py.refusal import ParameterError


def columns_of(
    text: str, columns: tuple[Mapping[str, float], ...], unread: Collection[str]
) -> list[tuple[float, ...]]:
    """The columns for `make` of `read_csv`; ParameterError as there, with the line alone."""
    file = io.StringIO(text, newline="")
    lines = csv.reader(_without_comments(file.readlines(), columns), skipinitialspace=True)
    # The reader counts the lines: a row may have several.
    rows = [(lines.line_num, row) for row in lines if row]
    if not rows:
        raise _no_header(1, columns)
    (first, header), *body = rows
    header = [cell.strip() for cell in header]
    chosen = _chosen(first, header, columns)
    for name in set(header) & set(unread):
        if any(_cells(header, body, name)):
            raise ParameterError(
                f"line {first}: column {name} is not read, expected zeros in it, or none"
            )
    for name in chosen:
        if header.count(name) > 1:
            raise ParameterError(f"line {first}: column {name} is listed twice, expected once")
    for line, row in body:
        # A comma in decimals makes two columns of one number.
        if any(cell.strip() for cell in row[len(header) :]):
            expected = f"expected at most {len(header)}, as in the header, and a point in decimals"
            raise ParameterError(f"line {line}: {len(row)} columns, {expected}")
    made: list[tuple[float, ...]] = []
    for name, names in zip(chosen, columns, strict=True):
        factor = names[name]
        made.append(tuple(factor * value for value in _cells(header, body, name)))
    return made


def _chosen(line: int, header: list[str], columns: tuple[Mapping[str, float], ...]) -> list[str]:
    """The name in the header of each column; ParameterError if it has none or several."""
    found = [[name for name in names if name in header] for names in columns]
    for names in found:
        if len(names) > 1:
            raise ParameterError(
                f"line {line}: {' and '.join(names)} are both there, expected one of them"
            )
    if all(found):
        return [name for (name,) in found]
    for separator in ";\t":
        if separator in "".join(header):
            expected = "expected ',', and a point in decimals"
            raise ParameterError(f"line {line}: columns are separated by {separator!r}, {expected}")
    raise _no_header(line, columns)


def _no_header(line: int, columns: tuple[Mapping[str, float], ...]) -> ParameterError:
    wanted: list[str] = []
    for names in map(list, columns):
        wanted.append(names[0] if len(names) == 1 else f"one of {' and '.join(names)}")
    listed = f"{', '.join(wanted[:-1])} and {wanted[-1]}"
    return ParameterError(f"line {line}: no header with the columns {listed}")


def _cells(header: list[str], body: list[tuple[int, list[str]]], name: str) -> Iterator[float]:
    """The numbers of a column; ParameterError for a cell that has none, or is not there."""
    place = header.index(name)
    for line, row in body:
        yield _number(row[place] if place < len(row) else None, name, line)


def _without_comments(lines: list[str], columns: tuple[Mapping[str, float], ...]) -> Iterator[str]:
    """The lines of a table, nothing in place of comments.

    The header is the first one, or behind # if that is none.
    """
    begun = _is_header(
        next((line for line in lines if line.strip() and line[0] != "#"), ""), columns
    )
    for line in lines:
        if not line.startswith("#"):
            begun = begun or bool(line.strip())
            yield line
            continue
        text = line.lstrip("# ")
        is_header = not begun and _is_header(text, columns)
        begun = begun or is_header
        yield text if is_header else ""


def _is_header(line: str, columns: tuple[Mapping[str, float], ...]) -> bool:
    cells = [cell.strip() for cell in line.split(",")]
    return all(any(name in cells for name in names) for names in columns)


def _number(text: str | None, column: str, line: int) -> float:
    try:
        value = float(text or "")
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ParameterError(f"line {line}: {column} is no finite number")
    return value
