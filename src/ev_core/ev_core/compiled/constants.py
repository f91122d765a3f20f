"""What an object is told once, as one row of numbers that compiled code reads: parameters, car, prepared constants.

    total  period  p ...  car ...  records of c ...  c ...  tables ...

`total` is the length of the row. A declared record in `c` is read by name from where it stands, like `p` and `car`. A
tuple of numbers in `c` (a table) stands there as its place and its length; the numbers themselves come at the end.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import is_dataclass
from typing import Any

import numpy as np

from ev_core.parameters.record import numbers, record_type
from ev_msgs_py.compilable import compilable

HEAD = ("total", "period")
_RECORD = "record_"  # the name of a record of `c`, with its number


def constants_type(trees: Mapping[str, Any], c: Any) -> np.dtype:
    """The layout of a row up to the numbers of `c` that stand alone."""
    parts = [(name, record_type(tree)) for name, tree in trees.items() if tree]
    parts += [(f"{_RECORD}{n}", record_type(record)) for n, record in enumerate(_records(c))]
    return np.dtype([*((name, np.float64) for name in HEAD), *parts])


def constants_row(trees: Mapping[str, Any], c: Any, period: float) -> np.ndarray:
    """The row of one object."""
    head = [0.0, period]
    for tree in trees.values():
        head += numbers(tree)
    leaves: list[Any] = []
    for leaf in _leaves(c):
        if is_dataclass(leaf):
            head += numbers(leaf)
        else:
            leaves.append(leaf)
    place = len(head) + sum(2 if isinstance(leaf, tuple) else 1 for leaf in leaves)
    tables: list[float] = []
    for leaf in leaves:
        if isinstance(leaf, tuple):
            head += [float(place + len(tables)), float(len(leaf))]
            tables += map(float, leaf)
        else:
            head.append(float(leaf))
    row = np.array(head + tables)
    row[0] = len(row)
    return row


def _leaves(c: Any) -> list[Any]:
    if c is None:
        return []
    if not hasattr(c, "_fields"):
        if not isinstance(c, (int, float, tuple, np.number)) and not is_dataclass(c):
            raise TypeError(f"prepare gives {type(c).__name__}, allowed is a NamedTuple of numbers and tuples")
        return [c]
    return [leaf for value in c for leaf in _leaves(value)]


def _records(c: Any) -> list[Any]:
    return [leaf for leaf in _leaves(c) if is_dataclass(leaf)]


@compilable
def table(row: Any, place: int) -> Any:
    """The table whose place and length stand at a place of the row."""
    begin = int(row[place])
    return row[begin : begin + int(row[place + 1])]


class Unpacking:
    """The source text that makes `c` of a row and of the record `k` at its beginning, and the names in it."""

    def __init__(self, c: Any, begin: int) -> None:
        self.names: dict[str, Any] = {"table": table}
        self._place = begin
        self._records = 0
        self.text = self._expression(c)

    def _expression(self, value: Any) -> str:
        if value is None:
            return "None"
        if hasattr(value, "_fields"):
            name = f"C_{len(self.names)}"
            self.names[name] = type(value)
            return f"{name}({', '.join(self._expression(inner) for inner in value)})"
        if is_dataclass(value):
            self._records += 1
            return f"k.{_RECORD}{self._records - 1}"
        place = self._place
        if isinstance(value, tuple):
            self._place += 2
            return f"table(row, {place})"
        self._place += 1
        return f"row[{place}]"
