"""A driver who follows a path by eye, and a speed or a pedal profile by foot."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from ev_core.law import Car, Vehicle, compilable, method, part, speed_along_path
from ev_msgs_py.contract.signals import BodyPose, BodyVelocity, DriverCommand, Instant, SteeringColumnState
from ev_sim.driver.lane_keeping import LaneKeepingParameters, LaneKeepingState, keep_lane
from ev_sim.driver.manoeuvre import UNBOUNDED, FeetParameters, FeetProfiles, FeetState, feet_profiles, work_pedals
from ev_sim.driver.path import Path, edge_notes, path_of
from ev_sim.profiles.profile import with_speed_profile_from_file


@dataclass(frozen=True, slots=True)
class PathFollowerParameters(FeetParameters, LaneKeepingParameters):
    """The path, how far ahead the driver looks, and hands and feet."""


@dataclass(slots=True)
class PathFollowerState:
    """What feet and hands remember."""

    feet: FeetState = part(FeetState)
    hands: LaneKeepingState = part(LaneKeepingState)


class Course(NamedTuple):
    """What the feet follow, and the path."""

    feet: FeetProfiles
    path: Path


def course_of(parameters: PathFollowerParameters, vehicle: Vehicle, period: float) -> Course:
    """The course that the parameters describe; ParameterError if they name a profile file that has not been read."""
    return Course(feet_profiles(parameters, vehicle, period), path_of(parameters.path))


def notes(p: PathFollowerParameters, s: PathFollowerState) -> tuple[str, ...]:
    """Whether the car has left its road."""
    return edge_notes(s.hands.edge, p.path.width)


@method(
    "driver",
    "path_follower",
    PathFollowerParameters,
    state=PathFollowerState,
    prepare=course_of,
    load_files=with_speed_profile_from_file,
    notes=notes,
    mirrored=True,
)
@compilable
def path_follower(
    p: PathFollowerParameters,
    car: Car,
    c: Course,
    s: PathFollowerState,
    period: float,
    now: Instant,
    body: BodyVelocity,
    pose: BodyPose,
    column: SteeringColumnState,
) -> DriverCommand:
    """Steer along a path by pure pursuit through the hand torque, forwards and in reverse."""
    speed = speed_along_path(body)
    drive, brake = work_pedals(p, car, c.feet, s.feet, period, now.time, speed, UNBOUNDED)
    return DriverCommand(drive, brake, keep_lane(p, car, c.path, s.hands, period, now.time, pose, speed, column))
