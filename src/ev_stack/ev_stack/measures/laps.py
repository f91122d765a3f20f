"""Laps of a closed course: times, distance from the racing line, and leaving the road.

How it works: the place of a car on the racing line is followed from sample to sample, not looked up
anew each time, since a course may cross itself: the nearest point counts unless it is far along the
line from the one before. The line is timed at its first point. A crossing counts where the car is
on that part of the course, between the edges, and farther round than ever before.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_sim.courses.course import CourseParameters
from ev_sim.courses.racing_line import RacingLine, racing_line
from ev_stack.measures import motion
from ev_stack.measures.metric import NotMeasured, channel
from ev_stack.recording.recording import Recording

# cosine of 45 deg, between the car and its part of a course: one across at right angles is farther
# off
_ALIGNED = 0.7
# [m] along the course between two samples: the nearest point is on another part of it, as at a
# crossing
_JUMP = 10.0


def line_of(course: CourseParameters | None, vehicle: Vehicle) -> RacingLine:
    """The racing line of a car; NotMeasured where no course is driven."""
    if course is None:
        raise NotMeasured("the driver has no closed course")
    return racing_line(course, max(vehicle.front_track, vehicle.rear_track))


def lap_times(run: Recording, vehicle: Vehicle, course: CourseParameters | None) -> np.ndarray:
    """Times of the laps [s], from line to line, linear between samples.

    NotMeasured if the car leaves the course, or comes to no end of a lap.
    """
    left_at = leaves(run, vehicle, course)
    # A lap beside the course is none: a car that cuts a bend is faster.
    if left_at is not None:
        raise NotMeasured(f"the car left the course at {left_at:.2f} s")
    crossed = _crossings(run, line_of(course, vehicle))
    if len(crossed) < 2:
        raise NotMeasured("no lap is driven to its end")
    return np.diff(crossed)


def laps_begun(run: Recording, vehicle: Vehicle, course: CourseParameters | None) -> int:
    """Number of forward crossings of the start line; NotMeasured where no course is driven."""
    return len(_crossings(run, line_of(course, vehicle)))


def path_error(run: Recording, vehicle: Vehicle, course: CourseParameters | None) -> float:
    """Root mean square distance of the centre of mass from the racing line in whole laps [m]."""
    line = line_of(course, vehicle)
    crossed = _crossings(run, line)
    if len(crossed) < 2:
        raise NotMeasured("no lap is driven to its end")
    within = (run.time >= crossed[0]) & (run.time <= crossed[-1])
    return float(np.sqrt(np.mean(_beside(run, line)[1][within] ** 2)))


def leaves(run: Recording, vehicle: Vehicle, course: CourseParameters | None) -> float | None:
    """When the outer wheels beside the centre of mass are first beyond an edge [s]; or None.

    The edges are those of the part of the course that the car has come to, so a car that cuts
    across leaves it.
    """
    line, half = line_of(course, vehicle), 0.5 * max(vehicle.front_track, vehicle.rear_track)
    at, off = _beside(run, line)
    off = off - vehicle.centre_of_mass_offset  # of the middle between the wheels
    # The outer wheels are half a track from the middle, on the side to which the car is off.
    gone = np.where(off >= 0.0, off > line.left[at] - half, -off > line.right[at] - half)
    return float(run.time[gone.argmax()]) if gone.any() else None


def _beside(run: Recording, line: RacingLine) -> tuple[np.ndarray, np.ndarray]:
    """Point of a line that the car has reached, (n,), and its distance to the left, (n,) [m]."""
    place = np.stack((channel(run, "pose.x"), channel(run, "pose.y")), axis=1)
    # The nearest point of the line ends one of two legs: that behind it and that before it.
    at = _progress(line, place, motion.heading(run))
    found = np.full(len(place), np.inf)
    for begin in (at, at - 1):
        start, length = line.points[begin], line.step[begin]
        leg, to = np.roll(line.points, -1, axis=0)[begin] - start, place - start
        # The foot of the perpendicular, but not beyond the ends of the leg.
        share = np.clip((to * leg).sum(axis=1) / length**2, 0.0, 1.0)
        distance = np.hypot(*(to - share[:, None] * leg).T)
        # The cross product is positive to the left of the leg; exactly on it is left, not 0.
        side = np.where(leg[:, 0] * to[:, 1] - leg[:, 1] * to[:, 0] < 0.0, -1.0, 1.0)
        found = np.where(distance < np.abs(found), side * distance, found)
    return at, found


def _progress(line: RacingLine, place: np.ndarray, heading: np.ndarray) -> np.ndarray:
    """Points of a line (n,) by which a car goes along it.

    They are the nearest ones, but none on a part of the line that crosses the car's.
    """
    nearest = _tree(line.points.tobytes()).query(place)[1]
    at = nearest.copy()
    ways = np.roll(line.points, -1, axis=0) - line.points
    # At the start, which is anywhere in a part of a run, any part may be near: the one that leads
    # where the car points.
    far = np.hypot(*(line.points - place[0]).T)
    ahead = ways @ np.array((np.cos(heading[0]), np.sin(heading[0]))) > _ALIGNED * np.hypot(*ways.T)
    near_by = far < far.min() + max(line.left.max(), line.right.max())
    if (candidates := np.flatnonzero(near_by & ahead)).size:
        at[0] = candidates[far[candidates].argmin()]
    # One number more than points: the last is the length of the closed line.
    along = np.concatenate(([0.0], np.cumsum(line.step)))
    length, count = along[-1], len(line.step)
    # By the shortest step, so that the window covers at least _JUMP wherever it is.
    reach = int(np.ceil(_JUMP / line.step.min()))
    for n in range(1, len(at)):
        jump = abs(along[nearest[n]] - along[at[n - 1]])
        # The shorter way round: across the start line the way along falls back to 0.
        if min(jump, length - jump) > _JUMP:
            window = (at[n - 1] + np.arange(-reach, reach + 1)) % count
            at[n] = window[np.hypot(*(line.points[window] - place[n]).T).argmin()]
    return at


@lru_cache(8)
def _tree(points: bytes) -> Any:
    """The tree of the points of a line, in which the nearest one is looked up."""
    from scipy.spatial import cKDTree  # slow to import, and most runs have no laps

    return cKDTree(np.frombuffer(points).reshape(-1, 2))


def _crossings(run: Recording, line: RacingLine) -> np.ndarray:
    """Times of the forward passes of the first point of a line, between the edges [s].

    A car that goes back over the line and forwards again has passed it once.
    """
    start = line.points[0]
    # The direction of the line at its first point, from its neighbours on both sides.
    along = line.points[1] - line.points[-1]
    along = along / np.hypot(*along)
    x, y = channel(run, "pose.x") - start[0], channel(run, "pose.y") - start[1]
    passed, off = x * along[0] + y * along[1], y * along[0] - x * along[1]
    turns = np.diff((passed >= 0.0).astype(int))  # 1 forwards, -1 back
    between = (off[1:] < line.left[0]) & (-off[1:] < line.right[0])
    # A part of the course that crosses the one with the line passes it as well.
    to_line = np.concatenate(([0.0], np.cumsum(line.step)))[_beside(run, line)[0][1:]]
    there = np.minimum(to_line, line.step.sum() - to_line) < _JUMP + line.step.max()
    before = np.flatnonzero(turns * (between & there))
    # Net passes so far: only one that sets a new maximum begins a lap.
    laps = np.cumsum(turns[before])
    before = before[laps > np.maximum.accumulate(np.append(0, laps[:-1]))]
    # The instant of the pass, linear between the two samples.
    share = -passed[before] / (passed[before + 1] - passed[before])
    return run.time[before] + share * (run.time[before + 1] - run.time[before])
