"""The path that a driver follows: waypoints, or arcs one after the other."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

from ev_core.law import BodyPose, ParameterError, compilable, cos, entry, hypot, setting, sin

PATH_SHAPES = WAYPOINTS, ARCS = "waypoints", "arcs"
_ARC_STEP = 0.5  # [m], chord of an arc; 3 mm from an arc of 10 m radius


@dataclass(frozen=True, slots=True)
class PathParameters:
    """A path in odom from its first point on; beyond both ends it goes on straight."""

    shape: str = setting(
        "waypoints", choices=PATH_SHAPES, about="straight lines between waypoints, or arcs from a start"
    )
    x: tuple[float, ...] = setting((0.0, 1.0), unit="m", low=-1e6, high=1e6, about="waypoints, at least two")
    y: tuple[float, ...] = setting(
        (0.0, 0.0), unit="m", low=-1e6, high=1e6, about="waypoints, at least two", lateral=True
    )
    length: tuple[float, ...] = setting((1.0,), unit="m", low=0.1, high=1e5, about="lengths of the arcs")
    curvature: tuple[float, ...] = setting(
        (0.0,), unit="1/m", low=-1.0, high=1.0, about="curvatures of the arcs, left positive, 0: straight", lateral=True
    )
    start_x: float = setting(0.0, unit="m", low=-1e6, high=1e6, about="where the first arc begins")
    start_y: float = setting(0.0, unit="m", low=-1e6, high=1e6, about="where the first arc begins", lateral=True)
    start_heading: float = setting(
        0.0, unit="rad", low=-10.0, high=10.0, about="direction of the first arc", lateral=True
    )
    width: float = setting(
        7.0, unit="m", low=0.5, high=1e4, about="of the road, with the path in its middle; a run that leaves it says so"
    )

    def __post_init__(self) -> None:
        if len(self.x) != len(self.y) or len(self.x) < 2:
            raise ParameterError("x and y need the same number of elements, at least two")
        if any(a == b for a, b in pairwise(zip(self.x, self.y, strict=True))):
            raise ParameterError("x and y repeat a waypoint, allowed are points apart from each other")
        if len(self.length) != len(self.curvature) or not self.length:
            raise ParameterError("length and curvature need the same number of elements, at least one")


class Path(NamedTuple):
    """A polyline by its legs: where each begins (x, y) [m], direction (x, y) [1], distance at its start, length [m]."""

    x: tuple[float, ...]
    y: tuple[float, ...]
    along_x: tuple[float, ...]
    along_y: tuple[float, ...]
    start: tuple[float, ...]
    length: tuple[float, ...]


def path_of(parameters: PathParameters) -> Path:
    """The path that the parameters describe."""
    p = parameters
    points = list(zip(p.x, p.y, strict=True)) if p.shape == WAYPOINTS else _along_arcs(p)
    legs = []
    start = 0.0
    for (x0, y0), (x1, y1) in pairwise(points):
        length = hypot(x1 - x0, y1 - y0)
        legs.append((x0, y0, (x1 - x0) / length, (y1 - y0) / length, start, length))
        start += length
    return Path(*zip(*legs, strict=True))


@compilable
def nearest(path: Path, x: float, y: float, leg: int) -> tuple[float, int]:
    """Distance along the path [m] of the point next to (x, y) [m], and its leg, searched from a leg near by."""
    last = len(path.x) - 1
    passed = passed_on(path, leg, x, y)
    while passed > path.length[leg] and leg < last:
        leg += 1
        passed = passed_on(path, leg, x, y)
    while passed < 0.0 and leg > 0:
        leg -= 1
        passed = passed_on(path, leg, x, y)
    # The first and the last leg go on for ever.
    if passed < 0.0 and leg > 0:
        passed = 0.0
    elif passed > path.length[leg] and leg < last:
        passed = path.length[leg]
    return path.start[leg] + passed, leg


@compilable
def passed_on(path: Path, leg: int, x: float, y: float) -> float:
    """How far along a leg (x, y) lies [m]; negative before it."""
    return (x - path.x[leg]) * path.along_x[leg] + (y - path.y[leg]) * path.along_y[leg]


@compilable
def point_at(path: Path, distance: float, leg: int) -> tuple[float, float]:
    """The point (x, y) [m] at a distance along the path [m], searched from a leg near by."""
    last = len(path.x) - 1
    while distance > path.start[leg] + path.length[leg] and leg < last:
        leg += 1
    while distance < path.start[leg] and leg > 0:
        leg -= 1
    passed = distance - path.start[leg]
    return path.x[leg] + passed * path.along_x[leg], path.y[leg] + passed * path.along_y[leg]


def _along_arcs(p: PathParameters) -> list[tuple[float, float]]:
    points, heading = [(p.start_x, p.start_y)], p.start_heading
    for length, curvature in zip(p.length, p.curvature, strict=True):
        chords = math.ceil(length / _ARC_STEP) if curvature else 1
        turn = curvature * length / chords
        chord = length / chords * (sin(turn / 2) / (turn / 2) if turn else 1.0)
        for _ in range(chords):
            x, y = points[-1]
            points.append((x + chord * cos(heading + turn / 2), y + chord * sin(heading + turn / 2)))
            heading += turn
    return points


@dataclass(slots=True)
class RoadEdgeState:
    """When the car left the road, and how far it has been from the path."""

    has_left: float = entry(unit="", about="whether the centre of mass has been beyond an edge of the road")
    left_at: float = entry(unit="s", about="when it first was")
    farthest: float = entry(unit="m", about="largest distance of the centre of mass from the path")


@compilable
def watch_edge(path: Path, width: float, s: RoadEdgeState, time: float, pose: BodyPose, leg: int) -> None:
    """Keep when the centre of mass is first farther from the path than half the width [m] of the road."""
    distance, leg = nearest(path, pose.x, pose.y, leg)
    x, y = point_at(path, distance, leg)
    s.farthest = max(s.farthest, hypot(pose.x - x, pose.y - y))
    if s.has_left == 0.0 and s.farthest > 0.5 * width:
        s.has_left, s.left_at = 1.0, time


def edge_notes(s: RoadEdgeState, width: float) -> tuple[str, ...]:
    """One line about a car that has left the road; its distance by powers of ten, so that it seldom becomes another."""
    if not s.has_left:
        return ()
    farthest = next((limit for limit in (1000.0, 100.0, 10.0) if s.farthest > limit), 0.5 * width)
    return (f"the car left the road at {s.left_at:.2f} s and has been more than {farthest:g} m from its path",)
