"""Proportional, integral and derivative action with limits and anti-windup."""

from __future__ import annotations


class LimitedPid:
    """PID control whose integral holds while the output is limited, unless the error leads it back (clamping).

    The gains are per unit of the error, of its integral and of its rate; the integral part (in units of the output)
    belongs to the caller. `period` [s].
    """

    def __init__(self, proportional_gain: float, integral_gain: float, derivative_gain: float, period: float) -> None:
        self._proportional_gain = proportional_gain
        self._integral_step = integral_gain * period
        self._derivative_gain = derivative_gain

    def step(self, error: float, error_rate: float, integral: float, low: float, high: float) -> tuple[float, float]:
        """Output within low..high and the new integral part."""
        grown = integral + self._integral_step * error
        wanted = self._proportional_gain * error + self._derivative_gain * error_rate + grown
        if wanted > high:
            return high, min(grown, integral)
        if wanted < low:
            return low, max(grown, integral)
        return wanted, grown
