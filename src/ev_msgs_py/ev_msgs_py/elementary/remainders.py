"""Remainders of divisions, exact."""

from __future__ import annotations

from math import copysign, inf, nan

from ev_msgs_py.compiling.compilable import compilable


@compilable
def fmod(x: float, y: float) -> float:
    """Remainder x - n y with n the integer part of x/y; exact; NaN for x infinite or y zero.

    To the bit `math.fmod`, which the compiler does not know: between positive numbers % is the same.
    """
    size, step = abs(x), abs(y)
    if not (size < inf and step > 0.0):
        return nan
    return copysign(size % step, x)


@compilable
def remainder(x: float, y: float) -> float:
    """Remainder x - n y, n the integer nearest to x/y, the even one of two; exact; NaN for x infinite or y zero.

    To the bit `math.remainder`, which the compiler does not know; by the other remainder, as CPython does it.
    """
    size, step = abs(x), abs(y)
    if not (size < inf and step > 0.0):
        return nan
    if step == inf:
        return x
    rest = size % step
    other = step - rest
    if rest > other:
        rest = -other
    elif rest == other:
        # Half way: what x is without this half counts whole steps, an even or an odd number of them.
        rest -= 2.0 * ((0.5 * (size - rest)) % step)
    return copysign(1.0, x) * rest
