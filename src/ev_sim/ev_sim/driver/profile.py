"""A value over time, given by points."""

from __future__ import annotations

from bisect import bisect_right
from itertools import pairwise

from ev_msgs_py.parameters import ParameterError, parameter


def interpolation_parameter(default: str) -> str:
    """Declare how a profile goes from point to point."""
    return parameter(
        default,
        choices=("linear", "step"),
        about="linear from point to point, or in steps: each value from its time on until the next",
    )


def check_points(time_name: str, time: tuple[float, ...], value_name: str, value: tuple[float, ...]) -> None:
    """ParameterError unless there is at least one point, every time has a value and the times increase."""
    if not time or len(time) != len(value):
        raise ParameterError(
            f"{time_name} and {value_name} have {len(time)} and {len(value)} elements, allowed is the same number,"
            " at least one"
        )
    for earlier, later in pairwise(time):
        if not earlier < later:
            raise ParameterError(f"{time_name}: {later:g} s after {earlier:g} s is refused, allowed is increasing time")


class Profile:
    """Interpolate between points; before the first and after the last point their values hold.

    `time` [s] increases, `value` has its length and any unit, `interpolation` is linear or step.
    """

    def __init__(self, time: tuple[float, ...], value: tuple[float, ...], interpolation: str) -> None:
        self._time, self._value, self._linear = time, value, interpolation == "linear"

    def at(self, t: float) -> float:
        """The value at the time t [s]."""
        after = bisect_right(self._time, t)
        if after == 0:
            return self._value[0]
        start = self._value[after - 1]
        if not self._linear or after == len(self._time):
            return start
        begin, end = self._time[after - 1], self._time[after]
        return start + (self._value[after] - start) * ((t - begin) / (end - begin))
