"""The windows of a speed cycle, listed or found by rule, and what a driver does in each of them.

How it works: each leg of the speed profile stands, falls, or is traction; legs of one mode in a row
are a window. A short window between two of another mode then joins them (`windows_by_rule`). In a
run the mode is looked up by time (`mode_at`), afterwards for all times at once (`modes_at`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ev_core.law import ParameterError, compilable, group, parameter, setting
from ev_sim.profiles.profile import Profile, number_until

MODES = ("stop", "traction", "regen")
STOP, TRACTION, REGENERATION = range(len(MODES))


@dataclass(frozen=True, slots=True)
class WindowRuleParameters:
    """Limits of standing and falling speeds, and of windows that are too short to be one.

    On TRRL 1.1 the rule finds the windows that the dissertation lists, but for 49.7 s to 57.3 s,
    where the speed falls and the source goes on with traction.
    """

    standing_speed: float = parameter(
        1.0 / 3.6,
        unit="m/s",
        low=0.0,
        high=10.0,
        about="up to it the car stands",
        source="UN GTR 15: 1 km/h",
    )
    deceleration: float = parameter(
        0.1,
        unit="m/s^2",
        low=0.0,
        high=10.0,
        about="a speed that falls faster is slowed down by the drives",
        source="assumption: the least that the dissertation, section 2.6, calls regeneration is "
        "0.105 m/s^2",
    )
    longest_hold: float = parameter(
        5.0,
        unit="s",
        low=0.0,
        high=1000.0,
        about="a speed held no longer between two falls belongs to them",
        source="dissertation, section 2.6, 153.6 s to 158.6 s",
    )
    shortest: float = parameter(
        2.0,
        unit="s",
        low=0.0,
        high=1000.0,
        about="a window up to this length between two of one mode joins them",
        source="assumption: the shortest window that the dissertation lists has 3.9 s",
    )


def windows_by_rule(
    p: WindowRuleParameters, cycle: Profile
) -> tuple[tuple[float, ...], tuple[int, ...]]:
    """Times at which the windows of a cycle begin [s], and the places of their modes in MODES."""
    points = list(zip(cycle.time, cycle.value, strict=True))
    found: list[tuple[tuple[float, float], int]] = []
    # The last value holds for ever: a leg to infinity.
    for start, end in pairwise([*points, (math.inf, points[-1][1])]):
        then = end[1] if cycle.linear else start[1]
        falls = start[1] - then > p.deceleration * (end[0] - start[0])
        mode = (
            STOP if max(start[1], then) <= p.standing_speed else REGENERATION if falls else TRACTION
        )
        # Legs of one mode in a row are one window, which begins with the first.
        if not found or mode != found[-1][1]:
            found.append((start, mode))
    place = 1
    while place < len(found) - 1:
        ((begin, speed), mode), ((end, speed_then), following) = found[place : place + 2]
        # A speed that is held between two falls gets more time than a speed that rises.
        hold = mode == TRACTION and speed_then <= speed
        allowed = max(p.longest_hold, p.shortest) if hold else p.shortest
        # Times of a table have decimals that no float has.
        if (
            STOP not in (mode, following)
            and found[place - 1][1] == following
            and end - begin <= allowed + 1e-9
        ):
            # Window and successor go, so the window before them goes on. It may now be a short one
            # itself: look at it again.
            del found[place : place + 2]
            place = max(place - 1, 1)
        else:
            place += 1
    return tuple(point[0] for point, _ in found), tuple(mode for _, mode in found)


@dataclass(frozen=True, slots=True)
class CycleModesParameters:
    """The windows of a cycle; without any they follow from the profile by a rule."""

    begin: tuple[float, ...] = parameter(
        (),
        unit="s",
        low=0.0,
        high=1e5,
        about="times at which the windows begin, increasing; empty: found by the rule",
        source="dissertation, section 2.6",
    )
    mode: tuple[str, ...] = setting(
        (), choices=MODES, about="what each window is for; the last one holds"
    )
    rule: WindowRuleParameters = group(WindowRuleParameters)

    def __post_init__(self) -> None:
        if len(self.begin) != len(self.mode):
            raise ParameterError(
                f"begin and mode have {len(self.begin)} and {len(self.mode)} elements, expected "
                f"the same number"
            )
        for earlier, later in pairwise(self.begin):
            if not earlier < later:
                raise ParameterError(
                    f"begin: {later:g} s after {earlier:g} s is refused, expected increasing time"
                )


class CycleModes(NamedTuple):
    """Times at which the windows of a cycle begin [s], and the places of their modes in MODES."""

    begin: tuple[float, ...]
    mode: tuple[float, ...]


def cycle_modes(parameters: CycleModesParameters, cycle: Profile) -> CycleModes:
    """The windows that the parameters name, or those that the rule finds."""
    if parameters.begin:
        return CycleModes(
            parameters.begin, tuple(float(MODES.index(name)) for name in parameters.mode)
        )
    begin, mode = windows_by_rule(parameters.rule, cycle)
    return CycleModes(begin, tuple(map(float, mode)))


@compilable
def mode_at(modes: CycleModes, t: float) -> int:
    """The mode at the time t [s]; before the first window the car stands."""
    begun = number_until(modes.begin, t)
    return int(modes.mode[begun - 1]) if begun > 0 else STOP


def values_at(profile: Profile, times: np.ndarray) -> np.ndarray:
    """`profile.value_at` each of the times [s], both (n,)."""
    points, values = np.array(profile.time), np.array(profile.value)
    begun = np.searchsorted(points, times, side="right")
    start = np.maximum(begun - 1, 0)
    if profile.linear == 0.0:
        return values[start]
    end = np.minimum(begun, len(points) - 1)
    # Outside of the points their values hold.
    width = np.where(end > start, points[end] - points[start], 1.0)
    return values[start] + (values[end] - values[start]) * ((times - points[start]) / width)


def modes_at(modes: CycleModes, times: np.ndarray) -> np.ndarray:
    """`cycle_modes.mode_at` each of the times [s], both (n,)."""
    return np.array([STOP, *modes.mode], int)[np.searchsorted(modes.begin, times, side="right")]
