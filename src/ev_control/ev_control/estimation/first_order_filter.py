"""What estimates are kept in: records that are put back to their start, and first-order filters of measured numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, is_dataclass
from math import inf
from typing import Any

from ev_core.law import compilable, entry


def start_again(record: type) -> Callable[[Any], None]:
    """A compilable function that puts every number of a declared record back to its start value.

    Its text is made from the declaration, because compiled code reaches the fields of a record only by their names.
    """
    name, space = f"start_again_{record.__name__}", {"inf": inf, "__name__": __name__}
    exec("\n    ".join([f"def {name}(s):", *_assignments("s", record())]), space)
    again: Callable[[Any], None] = space[name]  # type: ignore[assignment]
    return compilable(again)


def _assignments(place: str, start: Any) -> Iterator[str]:
    for field in fields(start):
        name, value = f"{place}.{field.name}", getattr(start, field.name)
        if is_dataclass(value):
            yield from _assignments(name, value)
        elif isinstance(value, list):
            yield f"for n in range({len(value)}): {name}[n] = {value[0]!r}"
        else:
            yield f"{name} = {value!r}"


@dataclass(slots=True)
class Filtered:
    """A number behind a first-order filter, in its own unit."""

    value: float = entry(unit="its own", about="filtered number")
    known: float = entry(unit="1", about="whether there has been a number; the first one passes")


@compilable
def filter_share(period: float, time_constant: float) -> float:
    """Share of the gap that a first-order filter closes in one period, by implicit Euler [1]."""
    return period / (period + time_constant)


@compilable
def follow(s: Filtered, value: float, share: float) -> float:
    """The filtered number, a share of the gap nearer to this one."""
    if s.known == 0.0:
        s.known = 1.0
        s.value = value
    else:
        s.value += share * (value - s.value)
    return s.value


forget_filtered = start_again(Filtered)  # the next number then passes as the first one
