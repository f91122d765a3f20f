"""Proportional, integral and derivative action with limits and anti-windup."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import compilable


@compilable
def limited_pid(direct: float, growth: float, integral: float, low: float, high: float) -> tuple[float, float]:
    """Output within low..high and the new integral part, all in units of the output.

    The output is `direct`, the proportional and derivative action, plus the integral part with its `growth` in this
    period. The integral part holds while the output is limited, unless the error leads it back (clamping).
    """
    grown = integral + growth
    wanted = direct + grown
    if wanted > high:
        return high, min(grown, integral)
    if wanted < low:
        return low, max(grown, integral)
    return wanted, grown
