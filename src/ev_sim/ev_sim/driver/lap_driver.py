"""A driver at the limit on a closed course.

He keeps to its racing line, as fast as tyres and motors of his car allow.

How it works: line and speed are worked out before the run, and the laps are unrolled into one path
with a run-up and a run-out. In the run the hands follow the path by preview. The feet follow the
speed of a place so far ahead that the torque of their control is the one which the acceleration
along the line takes.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ev_core.law import (
    BodyPose,
    Car,
    DriverCommand,
    Vehicle,
    compilable,
    entry,
    group,
    method,
    part,
    speed_along_path,
    sqrt,
)
from ev_sim.courses.course import CourseParameters, with_course_from_file
from ev_sim.courses.racing_line import racing_line
from ev_sim.courses.speed_profile import LimitParameters, limits, speed_profile
from ev_sim.driver import path as paths
from ev_sim.driver.followers import AngleControlState, HandParameters, OnPath, turn_to_angle
from ev_sim.driver.pedals import SpeedControlParameters, SpeedControlState, follow_speed
from ev_sim.driver.preview_driver import Moving, Preview, PreviewState, look_ahead, preview_of
from ev_sim.driver.preview_gains import PreviewParameters

_RUN_UP, _RUN_OUT = 30.0, 150.0  # [m] of the course, before the first lap and behind the last one


@dataclass(frozen=True, slots=True)
class LapDriverParameters:
    """The course, how far the driver goes, how he looks ahead, and hands and feet."""

    course: CourseParameters = group(CourseParameters)
    limit: LimitParameters = group(LimitParameters)
    # Without an integral part: the speed ahead is what the torque is fed forward by.
    speed_control: SpeedControlParameters = group(
        SpeedControlParameters, integral_gain=0.0, max_drive_torque=6000.0, max_brake_torque=8000.0
    )
    preview: PreviewParameters = group(PreviewParameters)
    hands: HandParameters = group(HandParameters)


@dataclass(slots=True)
class LapDriverState:
    """Memory of feet, eyes and hands, and the time when the car left the course."""

    speed_control: SpeedControlState = part(SpeedControlState)
    preview: PreviewState = part(PreviewState)
    hands: AngleControlState = part(AngleControlState)
    has_left: float = entry(
        unit="", about="whether an outer wheel has been beyond an edge of the course"
    )
    left_at: float = entry(unit="s", about="when it first was")


class Laps(NamedTuple):
    """The line that is driven, unrolled.

    Each of its points has squared speed [m^2/s^2], curvature [1/m] and room. `left` and `right` are
    how far the centre of mass may be from it [m]. `ahead` is the time by which the wanted speed is
    that of a place farther on, so that the torque of its control is m r a [s].
    """

    path: paths.Path
    square: tuple[float, ...]
    curvature: tuple[float, ...]
    left: tuple[float, ...]
    right: tuple[float, ...]
    lateral: float
    braking: float
    driving: float
    ahead: float
    preview: Preview


def laps_of(p: LapDriverParameters, vehicle: Vehicle, period: float) -> Laps:
    """Knowledge of line and car; ParameterError if the course is too narrow for the car."""
    track = max(vehicle.front_track, vehicle.rear_track)
    line, ellipse = racing_line(p.course, track), limits(p.limit, vehicle)
    places = _unrolled(line.step, p.course.laps)
    steps = [float(line.step[place]) for place in places[:-1]]
    at = {
        name: tuple(getattr(line, name)[places].tolist()) for name in ("curvature", "left", "right")
    }
    gain = p.speed_control.proportional_gain
    return Laps(
        _path(line.points[places], steps),
        speed_profile(ellipse, vehicle, at["curvature"], steps),
        at["curvature"],
        # From the edge to the centre of mass while the outer wheel is on it.
        tuple(room - 0.5 * track for room in at["left"]),
        tuple(room - 0.5 * track for room in at["right"]),
        *dataclasses.astuple(ellipse),
        # A proportional control gives K (v_ahead - v), and v_ahead - v is about a t: t = m r/K
        # makes it m r a.
        vehicle.mass * vehicle.wheel_radius / gain if gain > 0.0 else 0.0,
        preview_of(p.preview, vehicle, period),
    )


def _unrolled(step: np.ndarray, laps: int) -> np.ndarray:
    """Places of the points of a closed line: a run-up, the laps, and a run-out."""
    n, before = len(step), 0
    # From farther back a car at the line of a small course is beside it.
    run_up = min(_RUN_UP, 0.25 * float(step.sum()))
    length = 0.0
    while length < run_up:
        # Negative places count back from the end of the closed line, as numpy has them.
        before -= 1
        length += step[before]
    behind, length = laps * n, 0.0
    while length < _RUN_OUT:
        length += step[behind % n]
        behind += 1
    return np.arange(before, behind + 1) % n


def _path(points: np.ndarray, steps: list[float]) -> paths.Path:
    legs, start = [], 0.0
    for ((x0, y0), (x1, y1)), length in zip(pairwise(points.tolist()), steps, strict=True):
        legs.append((x0, y0, (x1 - x0) / length, (y1 - y0) / length, start, length))
        start += length
    return paths.Path(*zip(*legs, strict=True))


@compilable
def speed_ahead(c: Laps, distance: float, leg: int) -> float:
    """Speed of the profile [m/s] at a distance along the path [m], without `scale`.

    It is searched from a leg near by.
    """
    path, last = c.path, len(c.path.x) - 1
    while distance > path.start[leg] + path.length[leg] and leg < last:
        leg += 1
    share = min(max((distance - path.start[leg]) / path.length[leg], 0.0), 1.0)
    return sqrt(max(c.square[leg] + share * (c.square[leg + 1] - c.square[leg]), 0.0))


@compilable
def wanted_speed(p: LimitParameters, c: Laps, distance: float, leg: int, speed: float) -> float:
    """Speed [m/s] that the feet follow.

    It is that of the profile, as far as the bend leaves acceleration at the present speed.
    """
    wanted = p.scale * speed_ahead(c, distance + abs(speed) * c.ahead, leg)
    # Accelerations go with the square of the speed.
    all_of_it = p.scale * p.scale
    across = (
        speed
        * speed
        * max(abs(c.curvature[leg]), abs(c.curvature[leg + 1]))
        / (all_of_it * c.lateral)
    )
    # What the friction ellipse leaves along the line, as a difference of speed at the time ahead.
    left = all_of_it * c.ahead * sqrt(max(1.0 - across * across, 0.0))
    return max(min(max(wanted, speed - left * c.braking), speed + left * c.driving), 0.0)


@compilable
def watch_edges(c: Laps, s: LapDriverState, time: float, pose: BodyPose, leg: int) -> None:
    """Keep the first time at which outer wheels are beyond an edge of the course.

    They count beside the centre of mass.
    """
    path = c.path
    share = min(max(paths.passed_on(path, leg, pose.x, pose.y) / path.length[leg], 0.0), 1.0)
    off = path.along_x[leg] * (pose.y - path.y[leg]) - path.along_y[leg] * (pose.x - path.x[leg])
    left = c.left[leg] + share * (c.left[leg + 1] - c.left[leg])
    right = c.right[leg] + share * (c.right[leg + 1] - c.right[leg])
    if s.has_left == 0.0 and (off > left or -off > right):
        s.has_left, s.left_at = 1.0, time


def with_course(parameters: LapDriverParameters) -> LapDriverParameters:
    """The same parameters with the course of its file, if it names one."""
    return dataclasses.replace(parameters, course=with_course_from_file(parameters.course))


def notes(p: LapDriverParameters, s: LapDriverState) -> tuple[str, ...]:
    """A line about a car that has left the course."""
    return (f"the car left the course at {s.left_at:.2f} s",) if s.has_left else ()


@method(
    "driver",
    "lap",
    prepare=laps_of,
    notes=notes,
    load_files=with_course,
    mirrored=True,
)
@compilable
def lap(
    p: LapDriverParameters, car: Car, c: Laps, s: LapDriverState, period: float, seen: OnPath
) -> DriverCommand:
    """Lap a closed course at the limit, its racing line by preview, its speed profile by pedals."""
    pose, column = seen.pose, seen.column
    speed = speed_along_path(seen.body)
    moving = Moving(pose, seen.body, column.angle / car.steering_ratio)
    angle = look_ahead(p.preview, c.preview, c.path, s.preview, period, moving)
    leg = int(s.preview.leg)
    distance = c.path.start[leg] + paths.passed_on(c.path, leg, pose.x, pose.y)
    wanted = wanted_speed(p.limit, c, distance, leg, speed)
    drive, brake = follow_speed(p.speed_control, car, s.speed_control, period, wanted, speed)
    watch_edges(c, s, seen.now.time, pose, leg)
    steered = car.steering_ratio * angle
    torque = turn_to_angle(p.hands.angle_control, s.hands, period, steered, column)
    return DriverCommand(drive, brake, torque)
