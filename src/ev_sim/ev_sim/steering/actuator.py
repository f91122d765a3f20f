"""An electric motor behind a gear that turns road wheels, as a servo of their angle."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from ev_core.law import compilable, entry, expm1, parameter

_LONGEST_STEP = 0.5e-3  # s, a quarter of the default lag of the torque


@dataclass(frozen=True, slots=True)
class SteeringMotorParameters:
    """Motor, gear, wheels and servo; no source describes one, the size is that of a rear axle of a compact car."""

    peak_torque: float = parameter(3.0, unit="N m", low=0.001, high=1000.0, about="largest torque at the shaft")
    peak_power: float = parameter(500.0, unit="W", low=1.0, high=1e5, about="largest power at the shaft")
    gear_ratio: float = parameter(
        400.0, unit="1", low=1.0, high=1e5, about="speed of the motor over that of the wheels"
    )
    rotor_inertia: float = parameter(5e-5, unit="kg m^2", low=0.0, high=1.0, about="inertia of the rotor")
    copper_loss: float = parameter(
        20.0, unit="W/(N m)^2", low=0.0, high=1e5, about="loss in the windings over squared torque"
    )
    torque_lag: float = parameter(0.002, unit="s", low=0.0005, high=1.0, about="first-order lag of the torque")
    wheel_inertia: float = parameter(
        2.0, unit="kg m^2", low=0.001, high=100.0, about="of both wheels about their steering axes"
    )
    damping: float = parameter(20.0, unit="N m s/rad", low=0.0, high=1e4, about="viscous friction at the wheels")
    max_angle: float = parameter(0.0873, unit="rad", low=0.001, high=1.0, about="angle of the end stops, 5 degrees")
    max_rate: float = parameter(0.5, unit="rad/s", low=0.001, high=100.0, about="fastest turning of the wheels")
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
        about="by which side forces act behind the steering axes, of tyre and suspension",
    )


@dataclass(slots=True)
class SteeringMotorState:
    """Wheels, torque and servo; left positive."""

    angle: float = entry(unit="rad", about="of the wheels")
    rate: float = entry(unit="rad/s", about="of the wheels")
    torque: float = entry(unit="N m", about="at the shaft")
    held: float = entry(unit="N m", about="torque at the shaft that the integral of the rate's error asks for")
    power: float = entry(unit="W", about="from the supply, mean over the last period")


class Servo(NamedTuple):
    """What follows from the parameters for steps of a width."""

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
def turn(p: SteeringMotorParameters, c: Servo, s: SteeringMotorState, wanted: float, moment: float) -> None:
    """Turn the wheels towards an angle [rad] for a period, against a moment of the road on them [N m].

    J w' = i M + M_road - b w with J = J_wheels + i^2 J_rotor; M follows J k_r (k_p (wanted - angle) - w)/i and its
    integral within peak torque, peak power and the rate limit. From the supply comes i M w + k_cu M^2; what brakes the
    wheels gives power back.
    """
    gear, work = p.gear_ratio, 0.0
    target = min(max(wanted, -p.max_angle), p.max_angle)
    for _ in range(int(c.steps)):
        missing = min(max(p.position_gain * (target - s.angle), -p.max_rate), p.max_rate) - s.rate
        asked = c.inertia * p.rate_gain * missing / gear + s.held
        speed = gear * abs(s.rate)
        most = p.peak_torque if p.peak_torque * speed <= p.peak_power else p.peak_power / speed
        if -most <= asked <= most:
            s.held += c.h * p.integral_gain * c.inertia * p.rate_gain * missing / gear
        else:
            asked = min(max(asked, -most), most)
        s.torque = min(max(s.torque + c.lag_share * (asked - s.torque), -most), most)
        rate = (s.rate + c.h * (gear * s.torque + moment) / c.inertia) / (1.0 + c.h * p.damping / c.inertia)
        mean = 0.5 * (s.rate + rate)
        s.angle += c.h * mean
        s.rate = rate
        if abs(s.angle) >= p.max_angle:
            s.angle = min(max(s.angle, -p.max_angle), p.max_angle)
            s.rate = 0.0
        work += c.h * (gear * s.torque * mean + p.copper_loss * s.torque * s.torque)
    s.power = work / (c.steps * c.h)
