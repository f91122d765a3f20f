"""The path that a driver follows: waypoints, or arcs one after the other."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

from ev_msgs_py.parameters import ParameterError, parameter

_ARC_STEP = 0.5  # [m], chord of an arc; 3 mm from an arc of 10 m radius


@dataclass(frozen=True, slots=True)
class PathParameters:
    """A path in odom from its first point on; beyond both ends it goes on straight."""

    shape: str = parameter(
        "waypoints", choices=("waypoints", "arcs"), about="straight lines between waypoints, or arcs from a start"
    )
    x: tuple[float, ...] = parameter((0.0, 1.0), unit="m", low=-1e6, high=1e6, about="waypoints, at least two")
    y: tuple[float, ...] = parameter((0.0, 0.0), unit="m", low=-1e6, high=1e6, about="waypoints, at least two")
    length: tuple[float, ...] = parameter((1.0,), unit="m", low=0.1, high=1e5, about="lengths of the arcs")
    curvature: tuple[float, ...] = parameter(
        (0.0,), unit="1/m", low=-1.0, high=1.0, about="curvatures of the arcs, left positive, 0 is straight"
    )
    start_x: float = parameter(0.0, unit="m", low=-1e6, high=1e6, about="where the first arc begins")
    start_y: float = parameter(0.0, unit="m", low=-1e6, high=1e6, about="where the first arc begins")
    start_heading: float = parameter(0.0, unit="rad", low=-10.0, high=10.0, about="direction of the first arc")

    def __post_init__(self) -> None:
        if len(self.x) != len(self.y) or len(self.x) < 2:
            raise ParameterError("x and y need the same number of elements, at least two")
        if any(a == b for a, b in pairwise(zip(self.x, self.y, strict=True))):
            raise ParameterError("x and y repeat a waypoint, allowed are points apart from each other")
        if len(self.length) != len(self.curvature) or not self.length:
            raise ParameterError("length and curvature need the same number of elements, at least one")


class Path:
    """A polyline with the distance along it."""

    def __init__(self, parameters: PathParameters) -> None:
        p = parameters
        points = list(zip(p.x, p.y, strict=True)) if p.shape == "waypoints" else _along_arcs(p)
        self._legs = []  # start (x, y), direction (x, y), distance at which it starts, length
        start = 0.0
        for (x0, y0), (x1, y1) in pairwise(points):
            length = math.dist((x0, y0), (x1, y1))
            self._legs.append((x0, y0, (x1 - x0) / length, (y1 - y0) / length, start, length))
            start += length
        self._last = len(self._legs) - 1

    def nearest(self, x: float, y: float, leg: int) -> tuple[float, int]:
        """Distance along the path [m] of the point next to (x, y) [m], and its leg, searched from a leg near by."""
        x0, y0, along_x, along_y, start, length = self._legs[leg]
        passed = (x - x0) * along_x + (y - y0) * along_y
        while passed > length and leg < self._last:
            leg += 1
            x0, y0, along_x, along_y, start, length = self._legs[leg]
            passed = (x - x0) * along_x + (y - y0) * along_y
        while passed < 0.0 and leg > 0:
            leg -= 1
            x0, y0, along_x, along_y, start, length = self._legs[leg]
            passed = (x - x0) * along_x + (y - y0) * along_y
        # The first and the last leg go on for ever.
        if passed < 0.0 and leg > 0:
            passed = 0.0
        elif passed > length and leg < self._last:
            passed = length
        return start + passed, leg

    def at(self, distance: float, leg: int) -> tuple[float, float]:
        """The point (x, y) [m] at a distance along the path [m], searched from a leg near by."""
        x0, y0, along_x, along_y, start, length = self._legs[leg]
        while distance > start + length and leg < self._last:
            leg += 1
            x0, y0, along_x, along_y, start, length = self._legs[leg]
        while distance < start and leg > 0:
            leg -= 1
            x0, y0, along_x, along_y, start, length = self._legs[leg]
        passed = distance - start
        return x0 + passed * along_x, y0 + passed * along_y


def _along_arcs(p: PathParameters) -> list[tuple[float, float]]:
    points, heading = [(p.start_x, p.start_y)], p.start_heading
    for length, curvature in zip(p.length, p.curvature, strict=True):
        chords = math.ceil(length / _ARC_STEP) if curvature else 1
        turn = curvature * length / chords
        chord = length / chords * (math.sin(turn / 2) / (turn / 2) if turn else 1.0)
        for _ in range(chords):
            x, y = points[-1]
            points.append((x + chord * math.cos(heading + turn / 2), y + chord * math.sin(heading + turn / 2)))
            heading += turn
    return points
