"""The driver's feet, which follow a speed or the pedals of standard manoeuvres.

How it works: `follow_speed` is a PI control of the speed. It shares a torque that slows down
between drives and brakes, and holds a car that is to stand. `work_pedals` follows the speed profile
by it until the pedal profile begins, which then gives both torques itself.

The driver `manoeuvre` works only these.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

from ev_core.law import (
    Vehicle,
    compilable,
    copysign,
    entry,
    group,
    method,
    parameter,
    part,
    setting,
)
from ev_core.vehicle.car import GRAVITY, Car, speed_along_path
from ev_msgs_py.contract.signals import BodyVelocity, DriverCommand, Instant
from ev_sim.profiles import profile as profiles

# The method of a driver that follows a speed profile, perhaps from a file.
driver_method = partial(
    method, "driver", load_files=profiles.with_speed_profile_from_file, mirrored=True
)


UNBOUNDED = 1e9  # [m/s], of a driver that nothing but the profile bounds


@compilable
def limited_pid(
    direct: float, growth: float, integral: float, low: float, high: float
) -> tuple[float, float]:
    """Output within low..high and the new integral part, all in units of the output.

    The output is `direct`, the proportional and derivative action, plus the integral part with its
    `growth` in this period. The integral part holds while the output is limited, unless the error
    leads it back (clamping).
    """
    grown = integral + growth
    wanted = direct + grown
    # At a limit the integral may only come back from it.
    if wanted > high:
        return high, min(grown, integral)
    if wanted < low:
        return low, max(grown, integral)
    return wanted, grown


@dataclass(frozen=True, slots=True)
class SpeedControlParameters:
    """PI control of the speed, and the limits of the pedals; all torques are sums over the wheels.

    The paper names the PI controller but gives neither gains nor limits. The gains suit a car of
    1400 kg.
    """

    proportional_gain: float = parameter(
        2000.0, unit="N m s/m", low=0.0, high=1e6, about="torque per speed error"
    )
    integral_gain: float = parameter(
        1000.0, unit="N m/m", low=0.0, high=1e6, about="torque per integral of the speed error"
    )
    max_drive_torque: float = parameter(
        1500.0, unit="N m", low=0.0, high=1e6, about="limit when driving, forwards or backwards"
    )
    max_regenerative_torque: float = parameter(
        600.0,
        unit="N m",
        low=0.0,
        high=1e6,
        about="limit of slowing drives; beyond it the friction brakes take over",
    )
    max_brake_torque: float = parameter(
        4000.0,
        unit="N m",
        low=0.0,
        high=1e6,
        about="limit of the friction brakes that slow down, about 1 g",
    )
    holding_share: float = parameter(
        2.0,
        unit="1",
        low=0.0,
        high=100.0,
        about="brake torque while the driver wants to stand, over weight times wheel radius, which "
        "is what all wheels "
        "together need on a slope of 90 deg: 2, so that the axle with the smaller share of the "
        "brakes holds, too",
    )
    standstill_speed: float = parameter(
        0.05, unit="m/s", low=0.0, high=1.0, about="speed below which the car counts as standing"
    )


@dataclass(slots=True)
class SpeedControlState:
    """Memory of the feet."""

    integral: float = entry(unit="N m", about="integral part of the speed control")
    holds: float = entry(unit="", about="1 while the car is held by the brake")


@compilable
def follow_speed(
    p: SpeedControlParameters,
    car: Car,
    s: SpeedControlState,
    period: float,
    wanted_speed: float,
    speed: float,
) -> tuple[float, float]:
    """Drive torque (positive forwards) and brake torque (never negative) [N m].

    Speeds [m/s]. A PI controller (Shchur 2019, fig. 3) gives the wanted torque. In the direction of
    travel it goes to the drives; against it, to the drives up to the regenerative limit, and the
    rest to the friction brakes. At rest, with rest wanted, the driver lets go of the drives and
    holds the brake, as hard as the steepest slope asks, and however far its tyres slide until they
    hold. An engine slows nothing down, and what is asked of it against its gear moves the selector:
    there all goes to the brakes.
    """
    standing = abs(speed) <= p.standstill_speed
    # Once held, the brake stays on until the driver wants to drive, however the car rocks on its
    # tyres.
    s.holds = 1.0 if wanted_speed == 0.0 and (standing or s.holds == 1.0) else 0.0
    if s.holds == 1.0:
        s.integral = 0.0
        return 0.0, p.holding_share * car.mass * GRAVITY * car.wheel_radius
    low, high = -p.max_drive_torque, p.max_drive_torque
    regenerative = p.max_regenerative_torque * (1.0 - car.engine_driven)
    slowing = regenerative + p.max_brake_torque
    # Brakes only act against the motion, so they widen the limit on that side alone.
    if speed > p.standstill_speed:
        low = -slowing
    elif speed < -p.standstill_speed:
        high = slowing
    error = wanted_speed - speed
    direct, growth = p.proportional_gain * error, p.integral_gain * period * error
    torque, s.integral = limited_pid(direct, growth, s.integral, low, high)
    # The part of a slowing torque that the drives do not take.
    brake = abs(torque) - regenerative
    if standing or torque * speed >= 0.0 or brake <= 0.0:
        return torque, 0.0
    return copysign(regenerative, torque), brake


@dataclass(frozen=True, slots=True)
class PedalProfileParameters:
    """Drive and brake torque over the time since the driver stopped to care about the speed."""

    begin: bool = setting(
        False, about="false: follow the speed profile throughout; true: change to these pedals"
    )
    begin_time: float = setting(0.0, unit="s", low=0.0, high=1e5, about="not before this time")
    begin_speed: float = setting(
        0.0, unit="m/s", low=0.0, high=100.0, about="not before the car is this fast, either way"
    )
    time: tuple[float, ...] = setting(
        (0.0,), unit="s", about="times of the points since then, increasing"
    )
    drive_torque: tuple[float, ...] = setting(
        (0.0,),
        unit="N m",
        low=-1e6,
        high=1e6,
        about="drive torques at these times, of all wheels together",
    )
    brake_torque: tuple[float, ...] = setting(
        (0.0,),
        unit="N m",
        low=0.0,
        high=1e6,
        about="brake torques at these times, of all wheels together",
    )
    interpolation: str = profiles.interpolation_parameter("linear")

    def __post_init__(self) -> None:
        profiles.check_points("time", self.time, "drive_torque", self.drive_torque)
        profiles.check_points("time", self.time, "brake_torque", self.brake_torque)


@dataclass(frozen=True, slots=True)
class FeetParameters:
    """The speed to follow, how, and the pedals that may take its place."""

    speed_profile: profiles.SpeedProfileParameters = group(profiles.SpeedProfileParameters)
    speed_control: SpeedControlParameters = group(SpeedControlParameters)
    pedals: PedalProfileParameters = group(PedalProfileParameters)


@dataclass(slots=True)
class FeetState:
    """Memory of the feet."""

    speed_control: SpeedControlState = part(SpeedControlState)
    has_begun: float = entry(unit="", about="whether the pedal profile has begun")
    begin: float = entry(unit="s", about="when it began")


class FeetProfiles(NamedTuple):
    """Profiles of speed [m/s] over time, and of both pedals [N m] since they began."""

    speed: profiles.Profile
    drive_torque: profiles.Profile
    brake_torque: profiles.Profile


def feet_profiles(parameters: FeetParameters, vehicle: Vehicle, period: float) -> FeetProfiles:
    """The profiles of the parameters; ParameterError if a file that they name has not been read."""
    pedals = parameters.pedals
    return FeetProfiles(
        profiles.wanted_speed(parameters.speed_profile),
        profiles.profile_of(pedals.time, pedals.drive_torque, pedals.interpolation),
        profiles.profile_of(pedals.time, pedals.brake_torque, pedals.interpolation),
    )


class Pace(NamedTuple):
    """Time, speed along the path, and the largest speed that the feet may follow."""

    time: float  # [s]
    speed: float  # [m/s], negative in reverse
    fastest: float  # [m/s], either way


@compilable
def work_pedals(
    p: FeetParameters, car: Car, c: FeetProfiles, s: FeetState, period: float, pace: Pace
) -> tuple[float, float]:
    """Drive and brake torque [N m].

    The speed profile is followed, but no faster than the pace allows, until the pedal profile
    begins.
    """
    time, speed, fastest = pace
    # Once begun it goes on, also when the car gets slower than `begin_speed`.
    if s.has_begun == 0.0 and _begins(p.pedals, time, speed):
        s.has_begun = 1.0
        s.begin = time
    if s.has_begun == 1.0:
        since = time - s.begin
        return profiles.value_at(c.drive_torque, since), profiles.value_at(c.brake_torque, since)
    wanted = min(max(profiles.value_at(c.speed, time), -fastest), fastest)
    return follow_speed(p.speed_control, car, s.speed_control, period, wanted, speed)


@compilable
def _begins(p: PedalProfileParameters, time: float, speed: float) -> bool:
    """True if the pedal profile takes the place of the speed profile."""
    return p.begin == 1.0 and time >= p.begin_time and abs(speed) >= p.begin_speed


class InSeat(NamedTuple):
    """Signals that a driver with hands off the steering wheel reads."""

    now: Instant
    body: BodyVelocity


@driver_method("manoeuvre", prepare=feet_profiles)
@compilable
def manoeuvre(
    p: FeetParameters, car: Car, c: FeetProfiles, s: FeetState, period: float, seen: InSeat
) -> DriverCommand:
    """Follow a speed profile, then a pedal profile, with the hands off the steering wheel."""
    pace = Pace(seen.now.time, speed_along_path(seen.body), UNBOUNDED)
    drive, brake = work_pedals(p, car, c, s, period, pace)
    return DriverCommand(drive, brake, 0.0)
