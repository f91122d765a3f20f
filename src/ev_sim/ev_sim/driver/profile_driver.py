"""The driver's hands, and a driver who follows profiles: speed, and hand torque or road-wheel angle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from ev_core.law import Car, Vehicle, compilable, entry, group, parameter, part, setting, speed_along_path
from ev_msgs_py.contract.signals import BodyVelocity, DriverCommand, Instant, SteeringColumnState
from ev_sim.driver.pedals import SpeedControlParameters, SpeedControlState, driver_method, follow_speed, limited_pid
from ev_sim.profiles import profile as profiles

WAYS = ("hand_torque", "angle")
GIVEN_TORQUE, GIVEN_ANGLE = range(len(WAYS))


@dataclass(frozen=True, slots=True)
class HandTorqueParameters:
    """Hand torque on the steering wheel over time, left positive."""

    time: tuple[float, ...] = setting((0.0,), unit="s", about="times of the points, increasing")
    torque: tuple[float, ...] = setting(
        (0.0,), unit="N m", low=-100.0, high=100.0, about="hand torques at these times; the last holds", lateral=True
    )
    interpolation: str = profiles.interpolation_parameter("step")

    def __post_init__(self) -> None:
        profiles.check_points("time", self.time, "torque", self.torque)


@dataclass(frozen=True, slots=True)
class WantedAngleParameters:
    """Wanted road-wheel angle over time, left positive."""

    time: tuple[float, ...] = setting((0.0,), unit="s", about="times of the points, increasing")
    angle: tuple[float, ...] = setting(
        (0.0,), unit="rad", low=-1.5, high=1.5, about="road-wheel angles at these times; the last holds", lateral=True
    )
    interpolation: str = profiles.interpolation_parameter("step")

    def __post_init__(self) -> None:
        profiles.check_points("time", self.time, "angle", self.angle)


@dataclass(frozen=True, slots=True)
class AngleControlParameters:
    """How the driver turns the steering wheel to an angle; stable with and without steering assistance."""

    max_rate: float = parameter(8.0, unit="rad/s", low=0.01, high=100.0, about="fastest turning of the steering wheel")
    max_hand_torque: float = parameter(8.0, unit="N m", low=0.0, high=100.0, about="largest hand torque, either way")
    proportional_gain: float = parameter(0.2, unit="N m/rad", low=0.0, high=100.0, about="torque per angle error")
    integral_gain: float = parameter(
        0.5, unit="N m/(rad s)", low=0.0, high=100.0, about="torque per integral of the error"
    )
    derivative_gain: float = parameter(
        0.03, unit="N m s/rad", low=0.0, high=100.0, about="torque per rate of the error"
    )


@dataclass(frozen=True, slots=True)
class SteeringParameters:
    """Which of the two profiles the hands follow, and how."""

    mode: str = setting(
        "angle", choices=WAYS, about="hand_torque: the given hand torque; angle: turn to the given road-wheel angle"
    )
    hand_torque: HandTorqueParameters = group(HandTorqueParameters)
    wanted_angle: WantedAngleParameters = group(WantedAngleParameters)
    angle_control: AngleControlParameters = group(AngleControlParameters)


@dataclass(slots=True)
class AngleControlState:
    """How far the hands have come."""

    reference: float = entry(unit="rad", about="rate-limited steering-wheel angle that the driver is turning to")
    integral: float = entry(unit="N m", about="integral part of the hand torque")


@compilable
def turn_to_angle(
    p: AngleControlParameters, s: AngleControlState, period: float, wanted_angle: float, column: SteeringColumnState
) -> float:
    """Hand torque [N m] towards a wanted steering-wheel angle [rad]: PID control behind a rate-limited reference.

    The driver feels and sees the steering wheel only and knows nothing of what moves it.
    """
    change = min(max(wanted_angle - s.reference, -(p.max_rate * period)), p.max_rate * period)
    s.reference += change
    error, error_rate = s.reference - column.angle, change / period - column.rate
    direct = p.proportional_gain * error + p.derivative_gain * error_rate
    growth = p.integral_gain * period * error
    hand_torque, s.integral = limited_pid(direct, growth, s.integral, -p.max_hand_torque, p.max_hand_torque)
    return hand_torque


@dataclass(frozen=True, slots=True)
class SpeedProfileDriverParameters:
    """What the driver wants, and how feet and hands go about it."""

    speed_profile: profiles.SpeedProfileParameters = group(profiles.SpeedProfileParameters)
    speed_control: SpeedControlParameters = group(SpeedControlParameters)
    steering: SteeringParameters = group(SteeringParameters)


@dataclass(slots=True)
class SpeedProfileDriverState:
    """What feet and hands remember."""

    speed_control: SpeedControlState = part(SpeedControlState)
    hands: AngleControlState = part(AngleControlState)


class Profiles(NamedTuple):
    """What is wanted over time: speed [m/s], hand torque [N m] or road-wheel angle [rad]."""

    speed: profiles.Profile
    hand_torque: profiles.Profile
    angle: profiles.Profile


def profiles_of(parameters: SpeedProfileDriverParameters, vehicle: Vehicle, period: float) -> Profiles:
    """The profiles of the parameters; ParameterError if they name a profile file that has not been read."""
    torque, angle = parameters.steering.hand_torque, parameters.steering.wanted_angle
    return Profiles(
        profiles.wanted_speed(parameters.speed_profile),
        profiles.profile_of(torque.time, torque.torque, torque.interpolation),
        profiles.profile_of(angle.time, angle.angle, angle.interpolation),
    )


@driver_method("speed_profile", SpeedProfileDriverParameters, state=SpeedProfileDriverState, prepare=profiles_of)
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
    t, wanted = now.time, profiles.value_at(c.speed, now.time)
    drive, brake = follow_speed(p.speed_control, car, s.speed_control, period, wanted, speed_along_path(body))
    if p.steering.mode == GIVEN_TORQUE:
        return DriverCommand(drive, brake, profiles.value_at(c.hand_torque, t))
    angle = car.steering_ratio * profiles.value_at(c.angle, t)
    return DriverCommand(drive, brake, turn_to_angle(p.steering.angle_control, s.hands, period, angle, column))
