"""Laps of a closed course: their times, the distance from the racing line, and whether the car leaves the road."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_sim.courses.course import CourseParameters
from ev_sim.courses.racing_line import RacingLine, racing_line
from ev_sim.measures.metric import NotMeasured, channel
from ev_sim.recording.recording import Recording

_JUMP = 10.0  # [m] along the course between two samples, which only a car makes that cuts across


def line_of(course: CourseParameters | None, vehicle: Vehicle) -> RacingLine:
    """The racing line of a car; NotMeasured where no course is driven."""
    if course is None:
        raise NotMeasured("the driver has no closed course")
    return racing_line(course, max(vehicle.front_track, vehicle.rear_track))


def lap_times(run: Recording, vehicle: Vehicle, course: CourseParameters | None) -> np.ndarray:
    """Times of the laps [s], from crossing the line of the course to crossing it again, linear between the samples.

    NotMeasured if the car leaves the course, or comes to no end of a lap.
    """
    left_at = leaves(run, vehicle, course)
    if left_at is not None:
        raise NotMeasured(f"the car left the course at {left_at:.2f} s")
    crossed = _crossings(run, line_of(course, vehicle))
    if len(crossed) < 2:
        raise NotMeasured("no lap is driven to its end")
    return np.diff(crossed)


def laps_begun(run: Recording, vehicle: Vehicle, course: CourseParameters | None) -> int:
    """How often the car crosses the line of the course forwards; NotMeasured where no course is driven."""
    return len(_crossings(run, line_of(course, vehicle)))


def path_error(run: Recording, vehicle: Vehicle, course: CourseParameters | None) -> float:
    """Root mean square of the distance of the centre of mass from the racing line in all whole laps [m]."""
    line = line_of(course, vehicle)
    crossed = _crossings(run, line)
    if len(crossed) < 2:
        raise NotMeasured("no lap is driven to its end")
    within = (run.time >= crossed[0]) & (run.time <= crossed[-1])
    return float(np.sqrt(np.mean(_beside(run, line)[1][within] ** 2)))


def leaves(run: Recording, vehicle: Vehicle, course: CourseParameters | None) -> float | None:
    """When the outer wheels beside the centre of mass are first beyond an edge, or the car cuts across [s]; or None."""
    line, half = line_of(course, vehicle), 0.5 * max(vehicle.front_track, vehicle.rear_track)
    at, off = _beside(run, line)
    gone = np.where(off >= 0.0, off > line.left[at] - half, -off > line.right[at] - half)
    along = np.concatenate(([0.0], np.cumsum(line.step)))
    jump = np.abs(np.diff(along[at]))
    gone[1:] |= np.minimum(jump, along[-1] - jump) > _JUMP
    return float(run.time[gone.argmax()]) if gone.any() else None


def _beside(run: Recording, line: RacingLine) -> tuple[np.ndarray, np.ndarray]:
    """The nearest point of a line, (n,), and how far left of the line the car is there, (n,) [m]."""
    place = np.stack((channel(run, "pose.x"), channel(run, "pose.y")), axis=1)
    at = _tree(line.points.tobytes()).query(place)[1]
    found = np.full(len(place), np.inf)
    for begin in (at, at - 1):
        start, length = line.points[begin], line.step[begin]
        leg, to = np.roll(line.points, -1, axis=0)[begin] - start, place - start
        share = np.clip((to * leg).sum(axis=1) / length**2, 0.0, 1.0)
        distance = np.hypot(*(to - share[:, None] * leg).T)
        side = np.where(leg[:, 0] * to[:, 1] - leg[:, 1] * to[:, 0] < 0.0, -1.0, 1.0)
        found = np.where(distance < np.abs(found), side * distance, found)
    return at, found


@lru_cache(8)
def _tree(points: bytes) -> Any:
    """The tree of the points of a line, in which the nearest one is looked up."""
    from scipy.spatial import cKDTree  # slow to import, and most runs have no laps

    return cKDTree(np.frombuffer(points).reshape(-1, 2))


def _crossings(run: Recording, line: RacingLine) -> np.ndarray:
    """When the car passes the first point of a line forwards, between the edges [s]; not once more after going back."""
    start = line.points[0]
    along = line.points[1] - line.points[-1]
    along = along / np.hypot(*along)
    x, y = channel(run, "pose.x") - start[0], channel(run, "pose.y") - start[1]
    passed, off = x * along[0] + y * along[1], y * along[0] - x * along[1]
    turns = np.diff((passed >= 0.0).astype(int))  # 1 forwards, -1 back
    before = np.flatnonzero(turns * ((off[1:] < line.left[0]) & (-off[1:] < line.right[0])))
    laps = np.cumsum(turns[before])
    before = before[laps > np.maximum.accumulate(np.append(0, laps[:-1]))]
    share = -passed[before] / (passed[before + 1] - passed[before])
    return run.time[before] + share * (run.time[before + 1] - run.time[before])
