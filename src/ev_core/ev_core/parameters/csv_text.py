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
    rows = [(lines.line_num, row) for row in lines if row]
    header = [cell.strip() for cell in rows[0][1]] if rows else []
    found = [[name for name in names if name in header] for names in columns]
    for names in found:
        if len(names) > 1:
            raise ParameterError(
                f"line {rows[0][0]}: {' and '.join(names)} are both there, expected one of them"
            )
    if any(not names for names in found):
        for separator in ";\t":
            if separator in "".join(header):
                expected = "expected ',', and a point in decimals"
                raise ParameterError(
                    f"line {rows[0][0]}: columns are separated by {separator!r}, {expected}"
                )
        wanted = [
            names[0] if len(names) == 1 else f"one of {' and '.join(names)}"
            for names in map(list, columns)
        ]
        line = rows[0][0] if rows else 1
        raise ParameterError(
            f"line {line}: no header with the columns {', '.join(wanted[:-1])} and {wanted[-1]}"
        )
    for name in set(header) & set(unread):
        place = header.index(name)
        if any(
            _number(row[place] if place < len(row) else None, name, line) for line, row in rows[1:]
        ):
            raise ParameterError(
                f"line {rows[0][0]}: column {name} is not read, expected zeros in it, or none"
            )
    if twice := [name for (name,) in found if header.count(name) > 1]:
        raise ParameterError(f"line {rows[0][0]}: column {twice[0]} is listed twice, expected once")
    for line, row in rows[1:]:
        if any(cell.strip() for cell in row[len(header) :]):
            expected = f"expected at most {len(header)}, as in the header, and a point in decimals"
            raise ParameterError(f"line {line}: {len(row)} columns, {expected}")
    chosen = [
        (name, header.index(name), names[name])
        for (name,), names in zip(found, columns, strict=True)
    ]
    return [
        tuple(
            factor * _number(row[place] if place < len(row) else None, name, line)
            for line, row in rows[1:]
        )
        for name, place, factor in chosen
    ]


def _without_comments(lines: list[str], columns: tuple[Mapping[str, float], ...]) -> Iterator[str]:
    """The lines of a table, nothing in place of comments; the header is the first one, or behind # if that is none."""
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
