"""The yaw rate that the driver is taken to want: neutral, of a designed understeer, or less where the rear slides.

The designed understeer is the characteristic of De Novellis, Sorniotti & Gruber (2015), Driving modes for designing the
cornering response of fully electric vehicles with multiple motors, Mechanical Systems and Signal Processing 64-65; the
weight by the sideslip of the rear axle that of Lenzo et al. (2021), Yaw rate and sideslip control using single input
single output direct yaw moment control, IEEE Transactions on Control Systems Technology 29.
"""

from dataclasses import dataclass
from typing import NamedTuple

from ev_control.estimation.wheel_dynamics import filter_share
from ev_core.law import Car, ParameterError, compilable, copysign, entry, exp, parameter

REFERENCES = ("neutral", "understeer", "sideslip_limit")
NEUTRAL, UNDERSTEER, SIDESLIP_LIMIT = range(len(REFERENCES))


LEAST_GRIP = 0.01  # [m/s^2], below that of any road


@dataclass(frozen=True, slots=True)
class ReferenceParameters:
    """The characteristic that the car is to have; the sources design it for each car and driving mode."""

    gradient: float = parameter(
        0.002, unit="s^2/m", low=1e-5, high=0.1, about="understeer K of the linear part, delta = L a_y/u^2 + K a_y"
    )
    linear_share: float = parameter(
        0.5, unit="1", low=0.0, high=0.99, about="end of the linear part, over the largest lateral acceleration"
    )
    grip_share: float = parameter(
        0.9, unit="1", low=0.1, high=1.0, about="largest lateral acceleration over what the believed friction allows"
    )
    lag: float = parameter(0.05, unit="s", low=0.001, high=1.0, about="first-order lag of the wanted yaw rate")
    first_sideslip: float = parameter(
        0.04, unit="rad", low=0.0, high=1.0, about="slip angle of the rear axle from which on less yaw rate is wanted"
    )
    last_sideslip: float = parameter(
        0.10, unit="rad", low=0.01, high=1.5, about="slip angle of the rear axle from which on the path alone counts"
    )

    def __post_init__(self) -> None:
        if self.last_sideslip <= self.first_sideslip:
            raise ParameterError(
                f"last_sideslip is {self.last_sideslip:g} rad, expected more than first_sideslip, "
                f"{self.first_sideslip:g} rad"
            )


@dataclass(slots=True)
class ReferenceState:
    """What lasts between steps."""

    yaw_rate: float = entry(unit="rad/s", about="wanted yaw rate, filtered")


class Wanted(NamedTuple):
    """What is wanted of the car."""

    yaw_rate: float  # [rad/s]
    rate: float  # of the yaw rate [rad/s^2]
    angle: float  # road-wheel angle at which a car of the linear part of the characteristic yaws so [rad]


@compilable
def wanted_motion(
    p: ReferenceParameters,
    car: Car,
    s: ReferenceState,
    period: float,
    kind: str,
    speed: float,
    road_wheel_angle: float,
    grip: float,
    lateral_acceleration: float,
    rear_sideslip: float,
) -> Wanted:
    """The wanted yaw rate at a speed that is not zero [m/s], by the acceleration a that the characteristic gives.

    r* = sgn(u delta) a(|delta|)/|u|; with a sideslip limit r* + w (a_y/u - r*), where w grows from 0 to 1 between
    `first_sideslip` and `last_sideslip` of the rear axle [rad]. `grip` is the lateral acceleration that the believed
    friction allows, a_y the measured one [m/s^2], the angle that of the road wheels [rad].
    """
    u, angle, largest = abs(speed), abs(road_wheel_angle), p.grip_share * max(grip, LEAST_GRIP)
    gradient = 0.0 if kind == NEUTRAL else p.gradient
    straight = car.wheelbase / (u * u)
    if kind == NEUTRAL:
        acceleration = min(angle / straight, largest)
    else:
        acceleration = designed_acceleration(p, straight, angle, largest)
    yaw_rate = copysign(acceleration / u, road_wheel_angle * speed)
    if kind == SIDESLIP_LIMIT:
        beyond = (abs(rear_sideslip) - p.first_sideslip) / (p.last_sideslip - p.first_sideslip)
        yaw_rate += min(max(beyond, 0.0), 1.0) * (lateral_acceleration / speed - yaw_rate)
    change = filter_share(period, p.lag) * (yaw_rate - s.yaw_rate)
    s.yaw_rate += change
    return Wanted(s.yaw_rate, change / period, s.yaw_rate * (car.wheelbase + gradient * u * u) / speed)


_ROUNDS = 30
_CLOSE = 1e-12  # [rad]


@compilable
def designed_acceleration(p: ReferenceParameters, straight: float, angle: float, largest: float) -> float:
    """The lateral acceleration a at which delta = L a/u^2 + d(a) [m/s^2], for an angle of at least 0 [rad].

    With y = d(a) it is the root of y + a(y) L/u^2 - delta, which is concave in y: from y = 0 Newton's steps rise to it
    and never pass it. `straight` is L/u^2 [s^2/m], `largest` bounds a.
    """
    linear, y, acceleration = p.linear_share * largest, 0.0, 0.0
    for _ in range(_ROUNDS):
        if y <= p.gradient * linear:
            acceleration, slope = y / p.gradient, 1.0 / p.gradient
        else:
            left = (largest - linear) * exp((p.gradient * linear - y) / ((largest - linear) * p.gradient))
            acceleration, slope = largest - left, left / ((largest - linear) * p.gradient)
        step = (angle - y - straight * acceleration) / (1.0 + straight * slope)
        y += step
        if step <= _CLOSE:
            break
    return acceleration
