"""Sums whose rounding errors are added up as well, so that hardly anything of them is left.

A sum is the pair of its value and of what rounding has lost of it; `EMPTY_SUM` is where it begins.
"""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import compilable

EMPTY_SUM = (0.0, 0.0)


@compilable
def plus(total: tuple[float, float], number: float) -> tuple[float, float]:
    """The sum with one more number; the error of one addition is exactly a number (Knuth's two-sum)."""
    before, lost = total
    value = before + number
    taken = value - before
    return value, lost + ((before - (value - taken)) + (number - taken))


@compilable
def rounded(total: tuple[float, float]) -> float:
    """The sum, rounded once."""
    return total[0] + total[1]
