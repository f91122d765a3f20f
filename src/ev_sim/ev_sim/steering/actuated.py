"""An electric motor that turns road wheels, and a steering wheel by wire (Shchur 2019).

How it works: `turn` is a cascade: the error of the angle asks for a rate, that of the rate for a
torque, within the limits of the motor. It turns rear wheels (`rear_axle`) as well as the front
wheels of `actuated`, where the steering wheel is an oscillator of its own.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from ev_core.law import Car, Vehicle, compilable, entry, expm1, group, parameter, part
from ev_msgs_py.contract.signals import SteeringColumnState
from ev_sim.steering.column import (
    SteeringWheelParameters,
    Turned,
    drive_moment,
    steering_column,
    steering_wheel,
)
from ev_sim.steering.friction_oscillator import Oscillator, oscillated

_LONGEST_STEP = 0.5e-3  # s, a quarter of the default lag of the torque


@dataclass(frozen=True, slots=True)
class SteeringMotorParameters:
    """Motor, gear, wheels and servo, sized as for a compact car's rear axle; no source has one."""

    peak_torque: float = parameter(
        3.0, unit="N m", low=0.001, high=1000.0, about="largest torque at the shaft"
    )
    peak_power: float = parameter(
        500.0, unit="W", low=1.0, high=1e5, about="largest power at the shaft"
    )
    gear_ratio: float = parameter(
        400.0, unit="1", low=1.0, high=1e5, about="speed of the motor over that of the wheels"
    )
    rotor_inertia: float = parameter(
        5e-5, unit="kg m^2", low=0.0, high=1.0, about="inertia of the rotor"
    )
    copper_loss: float = parameter(
        20.0, unit="W/(N m)^2", low=0.0, high=1e5, about="loss in the windings over squared torque"
    )
    torque_lag: float = parameter(
        0.002, unit="s", low=0.0005, high=1.0, about="first-order lag of the torque"
    )
    wheel_inertia: float = parameter(
        2.0, unit="kg m^2", low=0.001, high=100.0, about="of both wheels about their steering axes"
    )
    damping: float = parameter(
        20.0, unit="N m s/rad", low=0.0, high=1e4, about="viscous friction at the wheels"
    )
    max_angle: float = parameter(
        0.0873, unit="rad", low=0.001, high=1.0, about="angle of the end stops, 5 degrees"
    )
    max_rate: float = parameter(
        0.5, unit="rad/s", low=0.001, high=100.0, about="fastest turning of the wheels"
    )
    position_gain: float = parameter(
        30.0, unit="1/s", low=0.1, high=1000.0, about="wanted rate over error of the angle"
    )
    rate_gain: float = parameter(
        200.0, unit="1/s", low=0.1, high=1000.0, about="wanted acceleration over error of the rate"
    )
    integral_gain: float = parameter(
        20.0, unit="1/s", low=0.0, high=1000.0, about="of the error of the rate, over rate_gain"
    )
    trail: float = parameter(
        0.03,
        unit="m",
        low=-0.5,
        high=0.5,
        about="of the side forces behind the steering axes, by tyre and suspension",
    )


@dataclass(slots=True)
class SteeringMotorState:
    """Wheels, torque and servo; left positive."""

    angle: float = entry(unit="rad", about="of the wheels")
    rate: float = entry(unit="rad/s", about="of the wheels")
    torque: float = entry(unit="N m", about="at the shaft")
    held: float = entry(
        unit="N m", about="torque at the shaft that the integral of the rate's error asks for"
    )
    power: float = entry(unit="W", about="from the supply, mean over the last period")


class Servo(NamedTuple):
    """Constants of the servo, for steps of a width."""

    steps: float  # in a period
    h: float  # [s]
    lag_share: float  # of its way that the torque goes in a step [1]
    inertia: float  # of wheels and rotor, at the wheels [kg m^2]


def servo(p: SteeringMotorParameters, period: float) -> Servo:
    """The servo over a control period [s]."""
    steps = max(math.ceil(period / _LONGEST_STEP), 1)
    h = period / steps
    inertia = p.wheel_inertia + p.gear_ratio * p.gear_ratio * p.rotor_inertia
    return Servo(float(steps), h, -expm1(-h / p.torque_lag), inertia)


@compilable
def turn(
    p: SteeringMotorParameters, c: Servo, s: SteeringMotorState, wanted: float, moment: float
) -> None:
    """Turn the wheels towards an angle [rad] for a period, against a moment of the road [N m].

    J w' = i M + M_road - b w with J = J_wheels + i^2 J_rotor; M follows J k_r (k_p (wanted - angle)
    - w)/i and its integral within peak torque, peak power and the rate limit. From the supply comes
    i M w + k_cu M^2; what brakes the wheels gives power back.
    """
    gear, work = p.gear_ratio, 0.0
    target = min(max(wanted, -p.max_angle), p.max_angle)
    for _ in range(int(c.steps)):
        # The outer loop asks for a rate, within what the actuator may turn; the inner one for a
        # torque.
        missing = min(max(p.position_gain * (target - s.angle), -p.max_rate), p.max_rate) - s.rate
        asked = c.inertia * p.rate_gain * missing / gear + s.held
        speed = gear * abs(s.rate)
        # Compared as a product: at rest a power allows any torque.
        most = p.peak_torque if p.peak_torque * speed <= p.peak_power else p.peak_power / speed
        # The integral stands still at the limit, so that it does not wind up.
        if -most <= asked <= most:
            s.held += c.h * p.integral_gain * c.inertia * p.rate_gain * missing / gear
        else:
            asked = min(max(asked, -most), most)
        s.torque = min(max(s.torque + c.lag_share * (asked - s.torque), -most), most)
        # Damping is taken implicitly: it may be as large as one likes.
        rate = (s.rate + c.h * (gear * s.torque + moment) / c.inertia) / (
            1.0 + c.h * p.damping / c.inertia
        )
        mean = 0.5 * (s.rate + rate)
        s.angle += c.h * mean
        s.rate = rate
        # The stops take all kinetic energy.
        if abs(s.angle) >= p.max_angle:
            s.angle = min(max(s.angle, -p.max_angle), p.max_angle)
            s.rate = 0.0
        work += c.h * (gear * s.torque * mean + p.copper_loss * s.torque * s.torque)
    s.power = work / (c.steps * c.h)


@dataclass(frozen=True, slots=True)
class FeelParameters:
    """The motor at the steering wheel; the source has none."""

    share: float = parameter(
        0.0,
        unit="1",
        low=0.0,
        high=5.0,
        about="of the moment of the road on the road wheels over the steering ratio that the motor "
        "brings to the "
        "steering wheel; 1 feels like a mechanical column",
        source="Shchur 2019, introduction: no feedback; a motor for it is an assumption",
    )
    peak_torque: float = parameter(
        8.0, unit="N m", low=0.0, high=100.0, about="largest torque at the steering wheel"
    )
    copper_loss: float = parameter(
        2.0, unit="W/(N m)^2", low=0.0, high=1e4, about="loss in the windings over squared torque"
    )


@dataclass(frozen=True, slots=True)
class ActuatedParameters:
    """The actuator with the road wheels, the steering wheel, and other loads of the road wheels."""

    actuator: SteeringMotorParameters = group(
        SteeringMotorParameters, wheel_inertia=2.8, damping=7.5, max_angle=0.7, max_rate=1.0
    )
    stiffness: float = parameter(
        65.0,
        unit="N m/rad",
        low=0.0,
        high=1e5,
        about="restoring stiffness of road wheels, k_p",
        source="Shchur 2019",
    )
    drive_inertia: float = parameter(
        0.0,
        unit="kg m^2",
        low=0.0,
        high=100.0,
        about="inertia of one wheel with its drive, J_k in eq 3",
        source="Shchur 2019, eqs 1 and 3",
    )
    steering_wheel: SteeringWheelParameters = group(SteeringWheelParameters)
    feel: FeelParameters = group(FeelParameters)


@dataclass(slots=True)
class ActuatedState:
    """Road wheels with their motor, steering wheel, hands, and the front wheels; left positive."""

    actuator: SteeringMotorState = part(SteeringMotorState)
    angle: float = entry(unit="rad", about="of the steering wheel")
    rate: float = entry(unit="rad/s", about="of the steering wheel")
    hand_torque: float = entry(unit="N m", about="what acted up to now")
    feel: float = entry(unit="N m", about="torque of the motor at the steering wheel")
    feel_power: float = entry(unit="W", about="that it takes, mean over the last period")
    wheel_speed_difference: float = entry(
        unit="rad/s", about="right minus left front wheel, a period ago"
    )


class Moved(NamedTuple):
    """The actuator of the road wheels, and the steering wheel."""

    servo: Servo
    steering_wheel: Oscillator


def moved(p: ActuatedParameters, vehicle: Vehicle, period: float) -> Moved:
    """The actuator over a period [s], and a steering wheel with end stops as a connected one."""
    stop = vehicle.steering_ratio * p.actuator.max_angle
    return Moved(servo(p.actuator, period), steering_wheel(p.steering_wheel, stop, period))


@compilable
def shown(s: ActuatedState) -> SteeringColumnState:
    """The column at this instant; the hand torque is the one that acted up to now."""
    return SteeringColumnState(s.angle, s.rate, s.hand_torque, s.actuator.angle, s.actuator.rate)


@steering_column("actuated", prepare=moved, outputs=shown)
@compilable
def actuated(
    p: ActuatedParameters,
    car: Car,
    c: Moved,
    s: ActuatedState,
    period: float,
    read: Turned,
) -> None:
    """Turn the road wheels by an actuator to the angle that the steering wheel sets.

    The hands do not reach them. Steer-by-wire as in the introduction of Shchur (2019): wanted angle
    a/i, a dedicated electric actuator with a position loop (`steering_actuator.motor`), no feedback
    to the column (`feel.share` 0). Road wheels: eq 3 with the actuator in the place of i M_b, so
    the torque difference of the drives disturbs. Steering wheel: as `by_wire`, and the motor's
    torque, `feel.share` times the moment of the road over i, as a sensor at the rack shows it (the
    torque of the actuator would bring its own acceleration back, and swing). Left positive.
    """
    road = (
        drive_moment(car, p.drive_inertia, period, read.wheels, s) - p.stiffness * s.actuator.angle
    )
    s.hand_torque = read.driver.hand_torque
    felt = p.feel.share * road / car.steering_ratio
    s.feel = min(max(felt, -p.feel.peak_torque), p.feel.peak_torque)
    turn(p.actuator, c.servo, s.actuator, s.angle / car.steering_ratio, road)
    angle = s.angle
    s.angle, s.rate = oscillated(c.steering_wheel, angle, s.rate, read.driver.hand_torque + s.feel)
    s.feel_power = s.feel * (s.angle - angle) / period + p.feel.copper_loss * (s.feel * s.feel)
