"""A value over time, given by points."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

from ev_core.law import ParameterError, compilable, setting

INTERPOLATIONS = LINEAR, STEP = "linear", "step"


def interpolation_parameter(default: str) -> str:
    """Declare how a profile goes from point to point."""
    return setting(
        default,
        choices=INTERPOLATIONS,
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


class Profile(NamedTuple):
    """Points in time, increasing [s], their values in any unit, and whether lines lead from point to point (1 or 0)."""

    time: tuple[float, ...]
    value: tuple[float, ...]
    linear: float


def profile_of(time: tuple[float, ...], value: tuple[float, ...], interpolation: str) -> Profile:
    """The profile through points, whose `interpolation` is one of INTERPOLATIONS."""
    return Profile(time, value, float(interpolation == LINEAR))


@compilable
def value_at(profile: Profile, t: float) -> float:
    """The value at the time t [s]; before the first and after the last point their values hold."""
    after = number_until(profile.time, t)
    if after == 0:
        return profile.value[0]
    start = profile.value[after - 1]
    if profile.linear == 0.0 or after == len(profile.time):
        return start
    begin, end = profile.time[after - 1], profile.time[after]
    return start + (profile.value[after] - start) * ((t - begin) / (end - begin))


@compilable
def number_until(times: tuple[float, ...], t: float) -> int:
    """How many of the increasing times are not after t."""
    low, high = 0, len(times)
    while low < high:
        middle = (low + high) // 2
        if t < times[middle]:
            high = middle
        else:
            low = middle + 1
    return low
