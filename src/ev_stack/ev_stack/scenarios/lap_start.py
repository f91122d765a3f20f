"""Start of a car for laps of a closed course, and their duration: both follow from the course."""

from __future__ import annotations

from math import atan2, ceil
from typing import Any, NamedTuple

import numpy as np

from ev_core.lockstep.configuration import Configuration
from ev_sim.courses.course import CourseParameters
from ev_sim.courses.racing_line import racing_line
from ev_sim.courses.speed_profile import LimitParameters, limits, speed_profile

_BEFORE = 6.0  # [m] along the racing line, from the start to the line that times the laps
_SLOWER, _ROOM = 1.1, 5.0  # than the planned speed a driver drives; [s] to launch from rest
_BEYOND = 150.0  # [m] behind the last lap, in which the driver `lap` comes to rest


class LapStart(NamedTuple):
    """Parameters of the plant that put the car on the racing line; duration of the run [s]."""

    values: dict[str, Any]
    duration: float


def lap_start(driver: Configuration) -> LapStart | None:
    """Start on the course of a driver that laps one; None for another driver."""
    course: Any = getattr(driver.parameters, "course", None)
    if not isinstance(course, CourseParameters):
        return None
    vehicle = driver.common.vehicle
    line = racing_line(course, max(vehicle.front_track, vehicle.rear_track))
    leg, left = -1, _BEFORE
    # Backwards along the closed line, which ends at its first point.
    while left > line.step[leg]:
        left -= float(line.step[leg])
        leg -= 1
    # Within this leg, by what is left of the way.
    end, begin = line.points[leg + 1], line.points[leg]
    along = (end - begin) / line.step[leg]
    x, y = (end - left * along).tolist()
    values = {"initial_x": x, "initial_y": y, "initial_heading": atan2(along[1], along[0])}
    limit: LimitParameters = getattr(driver.parameters, "limit", LimitParameters())
    length = course.laps * float(line.step.sum()) + _BEYOND
    rounds = ceil(length / float(line.step.sum())) + 1
    step = np.tile(line.step, rounds)
    step = step[: np.searchsorted(np.cumsum(step), length) + 1]
    # One number more: both ends of every leg.
    curvature = np.tile(line.curvature, rounds)[: len(step) + 1]
    square = speed_profile(limits(limit, vehicle), vehicle, curvature.tolist(), step.tolist())
    speed = limit.scale * np.sqrt(square)
    # Each leg at the mean of the speeds at its ends.
    time = float((2.0 * step / (speed[1:] + speed[:-1])).sum())
    return LapStart(values, float(ceil(_SLOWER * time + _ROOM)))
