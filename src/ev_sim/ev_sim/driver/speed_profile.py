"""A driver who follows a speed over time, and steers by hand torque or to a road-wheel angle over time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from ev_core.law import Car, Vehicle, compilable, group, method, part, speed_along_path
from ev_msgs_py.contract.signals import BodyVelocity, DriverCommand, Instant, SteeringColumnState
from ev_sim.driver.speed_control import SpeedControlParameters, SpeedControlState, follow_speed
from ev_sim.driver.steering import HAND_TORQUE, AngleControlState, SteeringParameters, turn_to_angle
from ev_sim.profiles.profile import (
    Profile,
    SpeedProfileParameters,
    profile_of,
    value_at,
    wanted_speed,
    with_speed_profile_from_file,
)


@dataclass(frozen=True, slots=True)
class SpeedProfileDriverParameters:
    """What the driver wants, and how feet and hands go about it."""

    speed_profile: SpeedProfileParameters = group(SpeedProfileParameters)
    speed_control: SpeedControlParameters = group(SpeedControlParameters)
    steering: SteeringParameters = group(SteeringParameters)


@dataclass(slots=True)
class SpeedProfileDriverState:
    """What feet and hands remember."""

    speed_control: SpeedControlState = part(SpeedControlState)
    hands: AngleControlState = part(AngleControlState)


class Profiles(NamedTuple):
    """What is wanted over time: speed [m/s], hand torque [N m] or road-wheel angle [rad]."""

    speed: Profile
    hand_torque: Profile
    angle: Profile


def profiles_of(parameters: SpeedProfileDriverParameters, vehicle: Vehicle, period: float) -> Profiles:
    """The profiles of the parameters; ParameterError if they name a profile file that has not been read."""
    torque, angle = parameters.steering.hand_torque, parameters.steering.wanted_angle
    return Profiles(
        wanted_speed(parameters.speed_profile),
        profile_of(torque.time, torque.torque, torque.interpolation),
        profile_of(angle.time, angle.angle, angle.interpolation),
    )


@method(
    "driver",
    "speed_profile",
    SpeedProfileDriverParameters,
    state=SpeedProfileDriverState,
    prepare=profiles_of,
    load_files=with_speed_profile_from_file,
    mirrored=True,
)
@compilable
def speed_profile(
    p: SpeedProfileDriverParameters,
    car: Car,
    c: Profiles,
    s: SpeedProfileDriverState,
    period: float,
    now: Instant,
    body: BodyVelocity,
    column: SteeringColumnState,
) -> DriverCommand:
    """Follow a speed profile, and steer by a hand torque profile or to a road-wheel angle profile."""
    t, wanted = now.time, value_at(c.speed, now.time)
    drive, brake = follow_speed(p.speed_control, car, s.speed_control, period, wanted, speed_along_path(body))
    if p.steering.mode == HAND_TORQUE:
        return DriverCommand(drive, brake, value_at(c.hand_torque, t))
    angle = car.steering_ratio * value_at(c.angle, t)
    return DriverCommand(drive, brake, turn_to_angle(p.steering.angle_control, s.hands, period, angle, column))
