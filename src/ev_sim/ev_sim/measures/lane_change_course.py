"""The courses of the lane changes of ISO 3888, and the cones that a car touches."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_sim.measures import motion
from ev_sim.measures.metric import channel
from ev_sim.recording.recording import Recording

CONES = 4  # on each side of a lane, its ends included
# The vehicle description ends at the wheels; these assumptions make a body of it.
BODY_BESIDE_TRACK = 0.21  # [m], width of the body beyond the larger track: one tyre's width
OVERHANG = 0.7  # [m], of the body beyond each axle


@dataclass(frozen=True, slots=True)
class Course:
    """Lane, lane change, lane, lane change, lane, of `lengths` [m]; the outer lanes have one middle.

    Widths of the lanes are (factor, margin, least): factor times the width of the car and a margin, but at least so
    much [m]. The second lane's middle is `middles` [m] from that of the first one, or its near edge is `edges` [m] from
    the first one's edge on that side.
    """

    name: str
    lengths: tuple[float, ...]
    widths: tuple[tuple[float, float, float], ...]
    middles: float = 0.0
    edges: float = 0.0


DOUBLE_LANE_CHANGE = Course(
    "Double lane change, ISO 3888-1",
    (15.0, 30.0, 25.0, 25.0, 30.0),
    ((1.1, 0.25, 0.0), (1.2, 0.25, 0.0), (1.3, 0.25, 0.0)),
    middles=3.5,
)
OBSTACLE_AVOIDANCE = Course(
    "Obstacle avoidance, ISO 3888-2",
    (12.0, 13.5, 11.0, 12.5, 12.0),
    ((1.1, 0.25, 0.0), (1.0, 1.0, 0.0), (1.3, 0.25, 3.0)),
    edges=1.0,
)


@dataclass(frozen=True, slots=True)
class Lane:
    """A lane along x, from `start` to `end`, around `middle`, all in odom [m]."""

    start: float
    end: float
    middle: float
    width: float


def body_width(vehicle: Vehicle) -> float:
    """Width of the body [m]."""
    return max(vehicle.front_track, vehicle.rear_track) + BODY_BESIDE_TRACK


def side_of(run: Recording, course: Course = DOUBLE_LANE_CHANGE) -> float:
    """1 where the car changes to a lane on the left, -1 where to one on the right: where it is in the middle of it."""
    x, y = channel(run, "pose.x"), channel(run, "pose.y")
    middle = sum(course.lengths[:2]) + course.lengths[2] / 2
    return float(np.copysign(1.0, y[np.abs(x - middle).argmin()] + 0.0))


def lanes(vehicle: Vehicle, side: float, course: Course = DOUBLE_LANE_CHANGE) -> tuple[Lane, ...]:
    """The three lanes; the first begins at x = 0 and its middle is y = 0, the second lies on a `side`."""
    ends = np.concatenate(([0.0], np.cumsum(course.lengths)))
    widths = [max(factor * body_width(vehicle) + margin, least) for factor, margin, least in course.widths]
    offset = course.middles or widths[0] / 2 + course.edges + widths[1] / 2
    return tuple(
        Lane(float(ends[2 * n]), float(ends[2 * n + 1]), side * offset * (n % 2), width)
        for n, width in enumerate(widths)
    )


def cones(vehicle: Vehicle, side: float, course: Course = DOUBLE_LANE_CHANGE) -> np.ndarray:
    """Positions of the cones, (n, 2) [m]; the lane's edge is where a cone begins, so a cone is a point on it."""
    return np.array(
        [
            (x, lane.middle + side * lane.width / 2)
            for lane in lanes(vehicle, side, course)
            for x in np.linspace(lane.start, lane.end, CONES)
            for side in (-1, 1)
        ]
    )


def hit_cones(run: Recording, vehicle: Vehicle, course: Course = DOUBLE_LANE_CHANGE) -> np.ndarray:
    """Which of the cones came to lie under the body, (n,) bool."""
    x, y, heading = channel(run, "pose.x"), channel(run, "pose.y"), motion.heading(run)
    front = vehicle.wheelbase - vehicle.centre_of_mass_to_rear_axle + OVERHANG
    rear = vehicle.centre_of_mass_to_rear_axle + OVERHANG
    hit = []
    for cone_x, cone_y in cones(vehicle, side_of(run, course), course):
        ahead = (cone_x - x) * np.cos(heading) + (cone_y - y) * np.sin(heading)
        aside = (cone_y - y) * np.cos(heading) - (cone_x - x) * np.sin(heading)
        inside = (ahead > -rear) & (ahead < front) & (np.abs(aside) < body_width(vehicle) / 2)
        hit.append(bool(inside.any()))
    return np.array(hit)


def edges(run: Recording, vehicle: Vehicle) -> tuple[tuple[np.ndarray, np.ndarray], ...]:
    """Paths of the left and of the right end of the body beside the centre of mass, x and y (n,) each [m]."""
    x, y, heading = channel(run, "pose.x"), channel(run, "pose.y"), motion.heading(run)
    half = body_width(vehicle) / 2
    return tuple((x - side * half * np.sin(heading), y + side * half * np.cos(heading)) for side in (1, -1))
