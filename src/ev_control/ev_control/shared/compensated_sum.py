"""Sums whose rounding errors are added up as well, so that hardly anything of them is left."""

from __future__ import annotations

from typing import NamedTuple

from ev_msgs_py.compiling.compilable import compilable


class CompensatedSum(NamedTuple):
    """A sum of numbers, and what rounding has lost of it."""

    value: float
    lost: float


EMPTY_SUM = CompensatedSum(0.0, 0.0)


@compilable
def plus(total: CompensatedSum, number: float) -> CompensatedSum:
    """The sum with one more number; the error of one addition is exactly a number (Knuth's two-sum)."""
    value = total.value + number
    taken = value - total.value
    lost = (total.value - (value - taken)) + (number - taken)
    return CompensatedSum(value, total.lost + lost)


@compilable
def rounded(total: CompensatedSum) -> float:
    """The sum, rounded once."""
    return total.value + total.lost
