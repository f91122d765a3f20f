"""A first-order filter of measured numbers."""

from __future__ import annotations

from dataclasses import dataclass

from ev_core.law import compilable, entry


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


@compilable
def forget_filtered(s: Filtered) -> None:
    """Let the next number pass as the first one."""
    s.value = s.known = 0.0
