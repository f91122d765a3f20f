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
        self._points = list(zip(p.x, p.y, strict=True)) if p.shape == "waypoints" else _along_arcs(p)
        self._lengths = [math.dist(a, b) for a, b in pairwise(self._points)]
        self._start = [0.0]
        for length in self._lengths:
            self._start.append(self._start[-1] + length)

    def nearest(self, x: float, y: float, leg: int) -> tuple[float, int]:
        """Distance along the path [m] of the point next to (x, y) [m], and its leg, searched from a leg near by."""
        share = self._share(x, y, leg)
        while share > 1.0 and leg + 1 < len(self._lengths):
            leg += 1
            share = self._share(x, y, leg)
        while share < 0.0 and leg > 0:
            leg -= 1
            share = self._share(x, y, leg)
        low = 0.0 if leg > 0 else -math.inf
        high = 1.0 if leg + 1 < len(self._lengths) else math.inf
        return self._start[leg] + min(max(share, low), high) * self._lengths[leg], leg

    def at(self, distance: float, leg: int) -> tuple[float, float]:
        """The point (x, y) [m] at a distance along the path [m], searched from a leg near by."""
        while leg + 1 < len(self._lengths) and distance > self._start[leg + 1]:
            leg += 1
        while leg > 0 and distance < self._start[leg]:
            leg -= 1
        share = (distance - self._start[leg]) / self._lengths[leg]
        (x0, y0), (x1, y1) = self._points[leg], self._points[leg + 1]
        return x0 + share * (x1 - x0), y0 + share * (y1 - y0)

    def _share(self, x: float, y: float, leg: int) -> float:
        """Where (x, y) projects on the line of a leg: 0 at its beginning, 1 at its end."""
        (x0, y0), (x1, y1) = self._points[leg], self._points[leg + 1]
        return ((x - x0) * (x1 - x0) + (y - y0) * (y1 - y0)) / self._lengths[leg] ** 2


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
