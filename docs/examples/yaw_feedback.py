"""A first law of your own: the yaw rate is fed back to the torque difference of the front wheels."""

from dataclasses import dataclass

from ev_control.law import BrakeSplitParameters, differential, split
from ev_core.law import *


@dataclass(frozen=True, slots=True)
class Gains(BrakeSplitParameters):
    gain: float = parameter(3000.0, unit="N m s/rad", low=0.0, high=1e5, about="torque per error")
    reset_time: float = parameter(0.5, unit="s", low=0.01, high=100.0, about="of the integral")


@dataclass(slots=True)
class Memory:
    integral: float = entry(unit="rad", about="of the error")


@differential("yaw_feedback")
@compilable
def yaw_feedback(
    p: Gains,
    car: Car,
    s: Memory,
    period: float,
    driver: DriverCommand,
    column: SteeringColumnState,
    body: BodyVelocity,
) -> WheelTorqueRequest:
    """Turn by dM = K (e + int(e)/T), e = u delta/L - r the yaw rate that a neutral car has more."""
    error = body.longitudinal * column.road_wheel_angle / car.wheelbase - body.yaw_rate
    if abs(error) < 10.0:  # more is no measurement
        s.integral += error * period
    return split(p, car, driver, p.gain * (error + s.integral / p.reset_time))
