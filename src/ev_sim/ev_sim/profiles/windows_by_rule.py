"""The windows of a cycle whose source lists none: standing, falling speed, and the rest."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

from ev_msgs_py.parameters.declaration import parameter
from ev_sim.profiles.profile import Profile

MODES = ("stop", "traction", "regen")
STOP, TRACTION, REGENERATION = range(len(MODES))


@dataclass(frozen=True, slots=True)
class WindowRuleParameters:
    """What counts as standing and as falling, and which windows are too short to be one.

    On TRRL 1.1 the rule finds the windows that the dissertation lists, but for 49.7 s to 57.3 s, where the speed falls
    and the source goes on with traction.
    """

    standing_speed: float = parameter(
        1.0 / 3.6, unit="m/s", low=0.0, high=10.0, about="up to it the car stands", source="UN GTR 15: 1 km/h"
    )
    deceleration: float = parameter(
        0.1,
        unit="m/s^2",
        low=0.0,
        high=10.0,
        about="a speed that falls faster is slowed down by the drives",
        source="assumption: the least that the dissertation, section 2.6, calls regeneration is 0.105 m/s^2",
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


def windows_by_rule(p: WindowRuleParameters, cycle: Profile) -> tuple[tuple[float, ...], tuple[int, ...]]:
    """Times at which the windows of a cycle begin [s], and their modes as places in MODES."""
    points = list(zip(cycle.time, cycle.value, strict=True))
    found: list[tuple[tuple[float, float], int]] = []
    for start, end in pairwise([*points, (math.inf, points[-1][1])]):
        mode = _mode(p, start, end if cycle.linear else (end[0], start[1]))
        if not found or mode != found[-1][1]:
            found.append((start, mode))
    place = 1
    while place < len(found) - 1:
        ((begin, speed), mode), ((end, speed_then), following) = found[place : place + 2]
        hold = mode == TRACTION and speed_then <= speed
        allowed = max(p.longest_hold, p.shortest) if hold else p.shortest
        # Times of a table have decimals that no float has.
        if STOP not in (mode, following) and found[place - 1][1] == following and end - begin <= allowed + 1e-9:
            del found[place : place + 2]
            place = max(place - 1, 1)
        else:
            place += 1
    return tuple(point[0] for point, _ in found), tuple(mode for _, mode in found)


def _mode(p: WindowRuleParameters, start: tuple[float, float], end: tuple[float, float]) -> int:
    if max(start[1], end[1]) <= p.standing_speed:
        return STOP
    falls = start[1] - end[1] > p.deceleration * (end[0] - start[0])
    return REGENERATION if falls else TRACTION
