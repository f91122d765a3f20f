"""The driver's hands, and drivers that follow profiles of speed and steering, or a path by eye.

How it works: a driver is feet (`pedals`) and hands. Hands give a torque, or turn the steering wheel
to an angle by a PID control of their torque (`turn_to_angle`). The angle comes from a profile, or
from pure pursuit of a path (`keep_lane`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

from ev_core.law import Vehicle, atan2, compilable, copysign, entry, group, parameter, part, setting
from ev_core.vehicle.car import Car, speed_along_path
from ev_msgs_py.contract.signals import (
    BodyPose,
    BodyVelocity,
    DriverCommand,
    Instant,
    SteeringColumnState,
)
from ev_sim.driver import pedals
from ev_sim.driver.path import (
    Path,
    PathParameters,
    RoadEdgeState,
    edge_notes,
    nearest,
    path_of,
    point_at,
    watch_edge,
)
from ev_sim.driver.pedals import (
    SpeedControlParameters,
    SpeedControlState,
    driver_method,
    follow_speed,
    limited_pid,
)
from ev_sim.profiles import profile as profiles

WAYS = ("hand_torque", "angle")
GIVEN_TORQUE, GIVEN_ANGLE = range(len(WAYS))


# Below it [m/s] a car does not drive anywhere, it rocks on its tyres or is pressed against its
# brakes: the eyes stay where they were, instead of following the sign of a velocity that is next to
# nothing.
LOOKING_ROUND = 0.05


@dataclass(frozen=True, slots=True)
class HandTorqueParameters:
    """Hand torque on the steering wheel over time, left positive."""

    time: tuple[float, ...] = setting((0.0,), unit="s", about="times of the points, increasing")
    torque: tuple[float, ...] = setting(
        (0.0,),
        unit="N m",
        low=-100.0,
        high=100.0,
        about="hand torques at these times; the last holds",
        lateral=True,
    )
    interpolation: str = profiles.interpolation_parameter("step")

    def __post_init__(self) -> None:
        profiles.check_points("time", self.time, "torque", self.torque)


@dataclass(frozen=True, slots=True)
class WantedAngleParameters:
    """Wanted road-wheel angle over time, left positive."""

    time: tuple[float, ...] = setting((0.0,), unit="s", about="times of the points, increasing")
    angle: tuple[float, ...] = setting(
        (0.0,),
        unit="rad",
        low=-1.5,
        high=1.5,
        about="road-wheel angles at these times; the last holds",
        lateral=True,
    )
    interpolation: str = profiles.interpolation_parameter("step")

    def __post_init__(self) -> None:
        profiles.check_points("time", self.time, "angle", self.angle)


@dataclass(frozen=True, slots=True)
class AngleControlParameters:
    """Control by which the driver turns the steering wheel to an angle.

    It is stable with and without steering assistance.
    """

    max_rate: float = parameter(
        8.0, unit="rad/s", low=0.01, high=100.0, about="fastest turning of the steering wheel"
    )
    max_hand_torque: float = parameter(
        8.0, unit="N m", low=0.0, high=100.0, about="largest hand torque, either way"
    )
    proportional_gain: float = parameter(
        0.2, unit="N m/rad", low=0.0, high=100.0, about="torque per angle error"
    )
    integral_gain: float = parameter(
        0.5, unit="N m/(rad s)", low=0.0, high=100.0, about="torque per integral of the error"
    )
    derivative_gain: float = parameter(
        0.03, unit="N m s/rad", low=0.0, high=100.0, about="torque per rate of the error"
    )


@dataclass(frozen=True, slots=True)
class SteeringParameters:
    """The profile that the hands follow, and how."""

    mode: str = setting(
        "angle",
        choices=WAYS,
        about="hand_torque: the given hand torque; angle: turn to the given road-wheel angle",
    )
    hand_torque: HandTorqueParameters = group(HandTorqueParameters)
    wanted_angle: WantedAngleParameters = group(WantedAngleParameters)
    angle_control: AngleControlParameters = group(AngleControlParameters)


@dataclass(slots=True)
class AngleControlState:
    """Angle and torque to which the hands have come."""

    reference: float = entry(
        unit="rad", about="rate-limited steering-wheel angle that the driver is turning to"
    )
    integral: float = entry(unit="N m", about="integral part of the hand torque")


@compilable
def turn_to_angle(
    p: AngleControlParameters,
    s: AngleControlState,
    period: float,
    wanted_angle: float,
    column: SteeringColumnState,
) -> float:
    """Hand torque [N m] towards a wanted steering-wheel angle [rad].

    It is a PID control behind a rate-limited reference. The driver feels and sees the steering
    wheel only and knows nothing of what moves it.
    """
    change = min(max(wanted_angle - s.reference, -(p.max_rate * period)), p.max_rate * period)
    s.reference += change
    # The rate is that of the limited reference: a jump of what is wanted gives no kick.
    error, error_rate = s.reference - column.angle, change / period - column.rate
    direct = p.proportional_gain * error + p.derivative_gain * error_rate
    growth = p.integral_gain * period * error
    hand_torque, s.integral = limited_pid(
        direct, growth, s.integral, -p.max_hand_torque, p.max_hand_torque
    )
    return hand_torque


@dataclass(frozen=True, slots=True)
class SpeedProfileDriverParameters:
    """Wanted speed and steering, and how feet and hands go about it."""

    speed_profile: profiles.SpeedProfileParameters = group(profiles.SpeedProfileParameters)
    speed_control: SpeedControlParameters = group(SpeedControlParameters)
    steering: SteeringParameters = group(SteeringParameters)


@dataclass(slots=True)
class SpeedProfileDriverState:
    """Memory of feet and hands."""

    speed_control: SpeedControlState = part(SpeedControlState)
    hands: AngleControlState = part(AngleControlState)


class Profiles(NamedTuple):
    """Wanted values over time: speed [m/s], hand torque [N m] or road-wheel angle [rad]."""

    speed: profiles.Profile
    hand_torque: profiles.Profile
    angle: profiles.Profile


def profiles_of(
    parameters: SpeedProfileDriverParameters, vehicle: Vehicle, period: float
) -> Profiles:
    """The profiles of the parameters; ParameterError if a file that they name has not been read."""
    torque, angle = parameters.steering.hand_torque, parameters.steering.wanted_angle
    return Profiles(
        profiles.wanted_speed(parameters.speed_profile),
        profiles.profile_of(torque.time, torque.torque, torque.interpolation),
        profiles.profile_of(angle.time, angle.angle, angle.interpolation),
    )


class AtWheel(NamedTuple):
    """Signals that a driver without a path reads."""

    now: Instant
    body: BodyVelocity
    column: SteeringColumnState


@driver_method("speed_profile", prepare=profiles_of)
@compilable
def speed_profile(
    p: SpeedProfileDriverParameters,
    car: Car,
    c: Profiles,
    s: SpeedProfileDriverState,
    period: float,
    seen: AtWheel,
) -> DriverCommand:
    """Follow a speed profile, and steer by a profile of hand torque or of road-wheel angle."""
    time, column = seen.now.time, seen.column
    wanted = profiles.value_at(c.speed, time)
    speed = speed_along_path(seen.body)
    drive, brake = follow_speed(p.speed_control, car, s.speed_control, period, wanted, speed)
    # A given torque acts as it is; only an angle needs hands that feel the steering wheel.
    if p.steering.mode == GIVEN_TORQUE:
        return DriverCommand(drive, brake, profiles.value_at(c.hand_torque, time))
    angle = car.steering_ratio * profiles.value_at(c.angle, time)
    torque = turn_to_angle(p.steering.angle_control, s.hands, period, angle, column)
    return DriverCommand(drive, brake, torque)


@dataclass(frozen=True, slots=True)
class PurePursuitParameters:
    """Distance ahead at which the driver looks."""

    preview_time: float = parameter(
        0.6,
        unit="s",
        low=0.0,
        high=10.0,
        about="the driver looks as far as the car goes in this time",
        source="assumption; 0.5 to 1.5 s are usual for drivers",
    )
    shortest_preview: float = parameter(
        4.0, unit="m", low=0.5, high=100.0, about="but at least this far"
    )
    max_angle: float = parameter(
        0.6, unit="rad", low=0.01, high=1.4, about="largest road-wheel angle, either way"
    )


@compilable
def pure_pursuit(
    p: PurePursuitParameters, car: Car, path: Path, pose: BodyPose, speed: float, leg: int
) -> tuple[float, int]:
    """Road-wheel angle [rad] at a speed, negative in reverse [m/s], and the reached leg.

    The rear axle is to roll on the circle through the point of the path at the preview distance:
    tan delta = 2 L y/(x^2 + y^2), (x, y) the point as seen from the rear axle (Coulter,
    Implementation of the pure pursuit path tracking algorithm, CMU-RI-TR-92-01, 1992). In reverse
    the point lies behind, the equation is the same: the rear axle, which leads then, does what it
    did forwards.
    """
    z, w = pose.orientation_z, pose.orientation_w
    cosine, sine = w * w - z * z, 2.0 * z * w  # of the heading, from its quaternion
    rear_arm = car.centre_of_mass_to_rear_axle
    rear_x, rear_y = pose.x - rear_arm * cosine, pose.y - rear_arm * sine
    preview = copysign(max(p.preview_time * abs(speed), p.shortest_preview), speed)
    distance, leg = nearest(path, rear_x, rear_y, leg)
    goal_x, goal_y = point_at(path, distance + preview, leg)
    ahead = (goal_x - rear_x) * cosine + (goal_y - rear_y) * sine
    aside = (goal_y - rear_y) * cosine - (goal_x - rear_x) * sine
    # The squared distance is never negative, so the angle stays within a right angle, goal behind
    # or not.
    angle = atan2(2.0 * car.wheelbase * aside, ahead * ahead + aside * aside)
    return min(max(angle, -p.max_angle), p.max_angle), leg


@dataclass(frozen=True, slots=True)
class HandParameters:
    """Control of the hands, firmer than when parking, to answer within tenths of a second."""

    angle_control: AngleControlParameters = group(
        AngleControlParameters,
        max_rate=15.0,
        max_hand_torque=20.0,
        proportional_gain=3.0,
        integral_gain=6.0,
        derivative_gain=0.3,
    )


@dataclass(frozen=True)  # without slots, to be a second base of other parameters
class LaneKeepingParameters:
    """The path, by default along the x axis, how far ahead the driver looks, and his hands."""

    path: PathParameters = group(PathParameters)
    pursuit: PurePursuitParameters = group(PurePursuitParameters)
    hands: HandParameters = group(HandParameters)


@dataclass(slots=True)
class LaneKeepingState:
    """State of hands and eyes."""

    hands: AngleControlState = part(AngleControlState)
    leg: float = entry(unit="1", about="place of the leg of the path that is reached")
    edge: RoadEdgeState = part(RoadEdgeState)
    direction: float = entry(1.0, unit="1", about="to which the eyes look: 1 ahead, -1 back")


class OnPath(NamedTuple):
    """Signals that a driver on a path reads."""

    now: Instant
    body: BodyVelocity
    pose: BodyPose
    column: SteeringColumnState


@compilable
def keep_lane(
    p: LaneKeepingParameters, car: Car, path: Path, s: LaneKeepingState, period: float, seen: OnPath
) -> float:
    """Hand torque [N m] that leads the car along its path by pure pursuit."""
    speed = speed_along_path(seen.body)
    if abs(speed) > LOOKING_ROUND:
        s.direction = 1.0 if speed > 0.0 else -1.0
    # About rest the eyes keep their direction, whatever sign a tiny speed has.
    looking = s.direction * abs(speed)
    angle, leg = pure_pursuit(p.pursuit, car, path, seen.pose, looking, int(s.leg))
    s.leg = float(leg)
    watch_edge(path, p.path.width, s.edge, seen.now.time, seen.pose, leg)
    wanted = car.steering_ratio * angle
    return turn_to_angle(p.hands.angle_control, s.hands, period, wanted, seen.column)


@dataclass(frozen=True, slots=True)
class PathFollowerParameters(pedals.FeetParameters, LaneKeepingParameters):
    """The path, how far ahead the driver looks, and hands and feet."""


@dataclass(slots=True)
class PathFollowerState:
    """Memory of feet and hands."""

    feet: pedals.FeetState = part(pedals.FeetState)
    hands: LaneKeepingState = part(LaneKeepingState)


class FollowedPath(NamedTuple):
    """Profiles of the feet, and the path."""

    feet: pedals.FeetProfiles
    path: Path


def followed_path(
    parameters: PathFollowerParameters, vehicle: Vehicle, period: float
) -> FollowedPath:
    """The course of the parameters; ParameterError if a file that they name has not been read."""
    return FollowedPath(pedals.feet_profiles(parameters, vehicle, period), path_of(parameters.path))


def road_notes(p: LaneKeepingParameters, s: Any) -> tuple[str, ...]:
    """A line about a car that has left its road."""
    return edge_notes(s.hands.edge, p.path.width)


@pedals.driver_method("path_follower", prepare=followed_path, notes=road_notes)
@compilable
def path_follower(
    p: PathFollowerParameters,
    car: Car,
    c: FollowedPath,
    s: PathFollowerState,
    period: float,
    seen: OnPath,
) -> DriverCommand:
    """Steer along a path by pure pursuit through the hand torque, forwards and in reverse."""
    pace = pedals.Pace(seen.now.time, speed_along_path(seen.body), pedals.UNBOUNDED)
    drive, brake = pedals.work_pedals(p, car, c.feet, s.feet, period, pace)
    return DriverCommand(drive, brake, keep_lane(p, car, c.path, s.hands, period, seen))
