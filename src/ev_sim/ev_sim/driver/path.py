"""The path that a driver follows, as waypoints or arcs, and how fast he takes its bends.

How it works: a path is a polyline. A driver keeps the leg that he has reached, and all searches
begin there, so that a path may cross itself and a step costs the same on paths of any length. The
speed plan goes along the path and back once, before the run: each corner has its own largest speed,
and the speeds between corners follow from one acceleration.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

from ev_core.law import (
    GRAVITY,
    BodyPose,
    atan2,
    compilable,
    cos,
    entry,
    hypot,
    parameter,
    setting,
    sin,
    sqrt,
    tan,
)
from ev_msgs_py.refusal import ParameterError
from ev_sim.driver.pedals import UNBOUNDED

PATH_SHAPES = WAYPOINTS, ARCS = "waypoints", "arcs"
_ARC_STEP = 0.5  # [m], chord of an arc; 3 mm from an arc of 10 m radius


_UNBOUNDED_SQUARE = UNBOUNDED * UNBOUNDED  # [m^2/s^2]
# Share of a leg within the circles at its ends from which on the leg is a chord of a bend.
_BENT = 0.99
# [m/s] by which a driver on the plan is too fast: more than his speed control lags behind
_MISSED = 1.0


@dataclass(frozen=True, slots=True)
class PathParameters:
    """A path in odom from its first point on; beyond both ends it goes on straight."""

    shape: str = setting(
        "waypoints",
        choices=PATH_SHAPES,
        about="straight lines between waypoints, or arcs from a start",
    )
    x: tuple[float, ...] = setting(
        (0.0, 1.0), unit="m", low=-1e6, high=1e6, about="waypoints, at least two"
    )
    y: tuple[float, ...] = setting(
        (0.0, 0.0), unit="m", low=-1e6, high=1e6, about="waypoints, at least two", lateral=True
    )
    length: tuple[float, ...] = setting(
        (1.0,), unit="m", low=0.1, high=1e5, about="lengths of the arcs"
    )
    curvature: tuple[float, ...] = setting(
        (0.0,),
        unit="1/m",
        low=-1.0,
        high=1.0,
        about="curvatures of the arcs, left positive, 0: straight",
        lateral=True,
    )
    start_x: float = setting(0.0, unit="m", low=-1e6, high=1e6, about="where the first arc begins")
    start_y: float = setting(
        0.0, unit="m", low=-1e6, high=1e6, about="where the first arc begins", lateral=True
    )
    start_heading: float = setting(
        0.0, unit="rad", low=-10.0, high=10.0, about="direction of the first arc", lateral=True
    )
    width: float = setting(
        7.0,
        unit="m",
        low=0.5,
        high=1e4,
        about="of the road, with the path in its middle; a run that leaves it says so",
    )

    def __post_init__(self) -> None:
        if len(self.x) != len(self.y) or len(self.x) < 2:
            raise ParameterError("x and y need the same number of elements, at least two")
        if any(a == b for a, b in pairwise(zip(self.x, self.y, strict=True))):
            raise ParameterError("x and y repeat a waypoint, expected points apart from each other")
        if len(self.length) != len(self.curvature) or not self.length:
            raise ParameterError(
                "length and curvature need the same number of elements, at least one"
            )


class Path(NamedTuple):
    """A polyline by its legs.

    Each has its begin (x, y) [m], direction (x, y) [1], distance at its start and length [m].
    """

    x: tuple[float, ...]
    y: tuple[float, ...]
    along_x: tuple[float, ...]
    along_y: tuple[float, ...]
    start: tuple[float, ...]
    length: tuple[float, ...]


@lru_cache(8)  # it is that of all runs of a batch
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
    """Distance along the path [m] of the point next to (x, y) [m], and its leg.

    It is searched from a leg near by.
    """
    last = len(path.x) - 1
    # Forwards first, then back; both only on the outer side of a corner, where the point is past
    # one leg and before the next.
    passed = passed_on(path, leg, x, y)
    while passed > path.length[leg] and leg < last:
        leg += 1
        passed = passed_on(path, leg, x, y)
    while passed < 0.0 and leg > 0:
        leg -= 1
        passed = passed_on(path, leg, x, y)
    # The first and the last leg go on for ever.
    # Outside of a corner it is the corner itself that is next.
    if passed < 0.0 and leg > 0:
        passed = 0.0
    elif passed > path.length[leg] and leg < last:
        passed = path.length[leg]
    return path.start[leg] + passed, leg


@compilable
def passed_on(path: Path, leg: int, x: float, y: float) -> float:
    """Distance along a leg [m] at which (x, y) [m] lies; negative before it."""
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
        # A straight needs no chords.
        chords = math.ceil(length / _ARC_STEP) if curvature else 1
        turn = curvature * length / chords
        # Length and direction of the chord of an arc: the direction is that of its middle.
        chord = length / chords * (sin(turn / 2) / (turn / 2) if turn else 1.0)
        for _ in range(chords):
            x, y = points[-1]
            points.append(
                (x + chord * cos(heading + turn / 2), y + chord * sin(heading + turn / 2))
            )
            heading += turn
    return points


@dataclass(slots=True)
class RoadEdgeState:
    """When the car left the road, and how far it has been from the path."""

    has_left: float = entry(
        unit="", about="whether the centre of mass has been beyond an edge of the road"
    )
    left_at: float = entry(unit="s", about="when it first was")
    farthest: float = entry(unit="m", about="largest distance of the centre of mass from the path")


@compilable
def watch_edge(
    path: Path, width: float, s: RoadEdgeState, time: float, pose: BodyPose, leg: int
) -> None:
    """Keep the first time at which the centre of mass is beyond an edge of the road.

    `width` is that of the road [m], with the path in its middle.
    """
    distance, leg = nearest(path, pose.x, pose.y, leg)
    x, y = point_at(path, distance, leg)
    s.farthest = max(s.farthest, hypot(pose.x - x, pose.y - y))
    if s.has_left == 0.0 and s.farthest > 0.5 * width:
        s.has_left, s.left_at = 1.0, time


def edge_notes(s: RoadEdgeState, width: float) -> tuple[str, ...]:
    """One line about a car that has left the road.

    The distance goes by powers of ten, so that the line seldom becomes another.
    """
    if not s.has_left:
        return ()
    farthest = next((limit for limit in (1000.0, 100.0, 10.0) if s.farthest > limit), 0.5 * width)
    return (
        f"the car left the road at {s.left_at:.2f} s and has been more than {farthest:g} m from "
        f"its path",
    )


@dataclass(frozen=True, slots=True)
class SpeedPlanParameters:
    """Lateral and longitudinal acceleration that the driver allows himself."""

    follow: bool = setting(
        True,
        about="true: never faster than the plan; false: the speed profile alone, whatever the "
        "bends are",
    )
    friction: float = parameter(
        0.9, unit="1", low=0.01, high=2.0, about="friction coefficient that the driver counts on"
    )
    share: float = parameter(
        0.5,
        unit="1",
        low=0.01,
        high=1.0,
        about="share of that friction that he uses in a bend",
        source="assumption; 3 to 5 m/s^2 are usual for drivers in a hurry",
    )
    acceleration: float = parameter(
        3.0,
        unit="m/s^2",
        low=0.1,
        high=20.0,
        about="by which he slows down before bends, and speeds up behind them",
    )
    cut: float = parameter(
        0.5,
        unit="m",
        low=0.01,
        high=100.0,
        about="how far he rounds off a corner between two waypoints",
    )


@dataclass(slots=True)
class SpeedPlanState:
    """Memory of a plan that was missed."""

    missed_at: float = entry(unit="s", about="when the car first was too fast")
    excess: float = entry(unit="m/s", about="by how much at most; 0 for never")


class SpeedPlan(NamedTuple):
    """Squares of largest speeds [m^2/s^2] at the points of the path, and on each of its legs.

    On a leg the speed changes from `begin` on, for `run` [m]; one within a bend is taken no faster
    than its faster end.
    """

    point: tuple[float, ...]
    leg: tuple[float, ...]
    begin: tuple[float, ...]
    run: tuple[float, ...]


@lru_cache(8)
def speed_plan(p: SpeedPlanParameters, path: Path) -> SpeedPlan:
    """The plan for a path: V^2/R = share x friction x g at each corner.

    It is less where another corner is too near. A corner of the angle phi is rounded off by the
    largest circle that touches both legs, not beyond their middles, and passes the corner no
    farther than `cut`: chords of an arc get the arc.
    """
    grip = p.share * p.friction * GRAVITY
    point, around = [_UNBOUNDED_SQUARE], [0.0]
    for n in range(1, len(path.x)):
        across = path.along_x[n - 1] * path.along_y[n] - path.along_y[n - 1] * path.along_x[n]
        along = path.along_x[n - 1] * path.along_x[n] + path.along_y[n - 1] * path.along_y[n]
        # A circle that touches both legs at a distance t from the corner has the radius
        # t/tan(phi/2).
        half = 0.5 * atan2(abs(across), along)
        touch, cosine = 0.5 * min(path.length[n - 1], path.length[n]), cos(half)
        around.append(
            min(touch, p.cut * cosine / (1.0 - cosine) * tan(half)) if cosine < 1.0 else touch
        )
        point.append(
            min(grip * around[n] / tan(half), _UNBOUNDED_SQUARE) if half else _UNBOUNDED_SQUARE
        )
    point.append(_UNBOUNDED_SQUARE)
    around.append(0.0)
    legs = range(len(path.x))
    begin = []
    run = []
    # Circles that fill the leg leave no straight on which the speed could change: it is a chord.
    bent = [around[n] + around[n + 1] > _BENT * path.length[n] for n in legs]
    for n in legs:
        begin.append(0.0 if bent[n] else around[n])
        run.append(path.length[n] if bent[n] else path.length[n] - around[n] - around[n + 1])
        point[n + 1] = min(point[n + 1], point[n] + 2.0 * p.acceleration * run[n])
    # Back from the end: early enough braking before each corner.
    for n in reversed(legs):
        point[n] = min(point[n], point[n + 1] + 2.0 * p.acceleration * run[n])
    leg = [max(point[n], point[n + 1]) if bent[n] else _UNBOUNDED_SQUARE for n in legs]
    return SpeedPlan(tuple(point), tuple(leg), tuple(begin), tuple(run))


class OnLeg(NamedTuple):
    """A car beside a leg of its path: place (x, y) [m], speed along the path [m/s], time [s]."""

    leg: int
    x: float
    y: float
    speed: float
    time: float


@compilable
def planned_speed(
    p: SpeedPlanParameters, plan: SpeedPlan, path: Path, s: SpeedPlanState, car: OnLeg
) -> float:
    """Largest speed [m/s], either way, at the place of a car; keeps when its speed was too high."""
    if p.follow == 0.0:
        return UNBOUNDED
    leg, twice = car.leg, 2.0 * p.acceleration
    since = passed_on(path, leg, car.x, car.y) - plan.begin[leg]
    # v^2 grows by 2 a s away from both corners; the plan is the least of what they allow.
    from_behind = plan.point[leg] + twice * max(since, 0.0)
    for_ahead = plan.point[leg + 1] + twice * max(plan.run[leg] - since, 0.0)
    planned = sqrt(min(plan.leg[leg], from_behind, for_ahead))
    excess = abs(car.speed) - planned
    if excess > _MISSED:
        if s.excess == 0.0:
            s.missed_at = car.time
        s.excess = max(s.excess, excess)
    return planned


def plan_notes(s: SpeedPlanState) -> tuple[str, ...]:
    """One line about a plan that was missed.

    By how much goes in few steps, so that the line seldom becomes another.
    """
    if not s.excess:
        return ()
    excess = next(limit for limit in (10.0, 5.0, 2.0, _MISSED) if s.excess > limit)
    return (
        f"the car was too fast for its speed plan from {s.missed_at:.2f} s on, by more than "
        f"{excess:g} m/s: bends ahead"
        " ask for a lower speed or a larger driver.plan.acceleration",
    )
