"""The pedals of standard manoeuvres, and a driver who works only these: the wheel is left to a steering robot."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from ev_core.law import Car, Vehicle, compilable, entry, group, method, part, setting, speed_along_path
from ev_msgs_py.contract.signals import BodyVelocity, DriverCommand, Instant
from ev_sim.driver.speed_control import SpeedControlParameters, SpeedControlState, follow_speed
from ev_sim.profiles.profile import (
    Profile,
    SpeedProfileParameters,
    check_points,
    interpolation_parameter,
    profile_of,
    value_at,
    wanted_speed,
    with_speed_profile_from_file,
)

UNBOUNDED = 1e9  # [m/s], of a driver whom nothing but the profile bounds


@dataclass(frozen=True, slots=True)
class PedalProfileParameters:
    """Drive and brake torque over the time since the driver stopped to care about the speed."""

    begin: bool = setting(False, about="false: follow the speed profile throughout; true: change to these pedals")
    begin_time: float = setting(0.0, unit="s", low=0.0, high=1e5, about="not before this time")
    begin_speed: float = setting(
        0.0, unit="m/s", low=0.0, high=100.0, about="not before the car is this fast, either way"
    )
    time: tuple[float, ...] = setting((0.0,), unit="s", about="times of the points since then, increasing")
    drive_torque: tuple[float, ...] = setting(
        (0.0,), unit="N m", low=-1e6, high=1e6, about="drive torques at these times, of all wheels together"
    )
    brake_torque: tuple[float, ...] = setting(
        (0.0,), unit="N m", low=0.0, high=1e6, about="brake torques at these times, of all wheels together"
    )
    interpolation: str = interpolation_parameter("linear")

    def __post_init__(self) -> None:
        check_points("time", self.time, "drive_torque", self.drive_torque)
        check_points("time", self.time, "brake_torque", self.brake_torque)


@dataclass(frozen=True, slots=True)
class FeetParameters:
    """The speed to follow, how, and the pedals that may take its place."""

    speed_profile: SpeedProfileParameters = group(SpeedProfileParameters)
    speed_control: SpeedControlParameters = group(SpeedControlParameters)
    pedals: PedalProfileParameters = group(PedalProfileParameters)


@dataclass(slots=True)
class FeetState:
    """What the feet remember."""

    speed_control: SpeedControlState = part(SpeedControlState)
    has_begun: float = entry(unit="", about="whether the pedal profile has begun")
    begin: float = entry(unit="s", about="when it began")


class FeetProfiles(NamedTuple):
    """The speed to follow over time [m/s], and both pedals over the time since they took its place [N m]."""

    speed: Profile
    drive_torque: Profile
    brake_torque: Profile


def feet_profiles(parameters: FeetParameters, vehicle: Vehicle, period: float) -> FeetProfiles:
    """The profiles of the parameters; ParameterError if the speed profile names a file that has not been read."""
    pedals = parameters.pedals
    return FeetProfiles(
        wanted_speed(parameters.speed_profile),
        profile_of(pedals.time, pedals.drive_torque, pedals.interpolation),
        profile_of(pedals.time, pedals.brake_torque, pedals.interpolation),
    )


@compilable
def work_pedals(
    p: FeetParameters,
    car: Car,
    profiles: FeetProfiles,
    s: FeetState,
    period: float,
    t: float,
    speed: float,
    fastest: float,
) -> tuple[float, float]:
    """Drive and brake torque [N m] at the time t [s] and the speed along the path [m/s].

    The speed profile is followed, but no faster than `fastest` [m/s], until the pedal profile begins, then that is.
    """
    pedals = p.pedals
    if s.has_begun == 0.0 and pedals.begin == 1.0 and t >= pedals.begin_time and abs(speed) >= pedals.begin_speed:
        s.has_begun = 1.0
        s.begin = t
    if s.has_begun == 1.0:
        since = t - s.begin
        return value_at(profiles.drive_torque, since), value_at(profiles.brake_torque, since)
    wanted = min(max(value_at(profiles.speed, t), -fastest), fastest)
    return follow_speed(p.speed_control, car, s.speed_control, period, wanted, speed)


@method(
    "driver",
    "manoeuvre",
    FeetParameters,
    state=FeetState,
    prepare=feet_profiles,
    load_files=with_speed_profile_from_file,
    mirrored=True,
)
@compilable
def manoeuvre(
    p: FeetParameters, car: Car, c: FeetProfiles, s: FeetState, period: float, now: Instant, body: BodyVelocity
) -> DriverCommand:
    """Follow a speed profile, then a pedal profile, with the hands off the steering wheel."""
    drive, brake = work_pedals(p, car, c, s, period, now.time, speed_along_path(body), UNBOUNDED)
    return DriverCommand(drive, brake, 0.0)
