"""Yaw rate that the driver is taken to want: neutral, of a designed understeer, or limited.

The designed understeer is the characteristic of De Novellis, Sorniotti & Gruber (2015), Driving
modes for designing the cornering response of fully electric vehicles with multiple motors,
Mechanical Systems and Signal Processing 64-65; the weight by the sideslip of the rear axle that of
Lenzo et al. (2021), Yaw rate and sideslip control using single input single output direct yaw
moment control, IEEE Transactions on Control Systems Technology 29.
"""

from dataclasses import dataclass
from enum import auto
from typing import NamedTuple

from ev_control.estimation.wheel_dynamics import filter_share
from ev_core.law import Car, Choice, ParameterError, compilable, copysign, entry, exp, parameter

LEAST_GRIP = 0.01  # [m/s^2], below that of any road
_ROUNDS = 30  # of Newton's steps
_CLOSE = 1e-12  # [rad], step that is small enough


class Reference(Choice):
    """Yaw rates that a driver may be taken to want."""

    NEUTRAL = auto()
    UNDERSTEER = auto()
    SIDESLIP_LIMIT = auto()


@dataclass(frozen=True, slots=True)
class ReferenceParameters:
    """Characteristic that the car is to have; the sources design it for each car and mode."""

    gradient: float = parameter(
        0.002,
        unit="s^2/m",
        low=1e-5,
        high=0.1,
        about="understeer K of the linear part, delta = L a_y/u^2 + K a_y",
    )
    linear_share: float = parameter(
        0.5,
        unit="1",
        low=0.0,
        high=0.99,
        about="end of the linear part, over the largest lateral acceleration",
    )
    grip_share: float = parameter(
        0.9,
        unit="1",
        low=0.1,
        high=1.0,
        about="largest lateral acceleration over what the believed friction allows",
    )
    lag: float = parameter(
        0.05, unit="s", low=0.001, high=1.0, about="first-order lag of the wanted yaw rate"
    )
    first_sideslip: float = parameter(
        0.04,
        unit="rad",
        low=0.0,
        high=1.0,
        about="slip angle of the rear axle from which on less yaw rate is wanted",
    )
    last_sideslip: float = parameter(
        0.10,
        unit="rad",
        low=0.01,
        high=1.5,
        about="slip angle of the rear axle from which on the path alone counts",
    )

    def __post_init__(self) -> None:
        if self.last_sideslip <= self.first_sideslip:
            raise ParameterError(
                f"last_sideslip is {self.last_sideslip:g} rad, expected more than first_sideslip, "
                f"{self.first_sideslip:g} rad"
            )


@dataclass(slots=True)
class ReferenceState:
    """State of the reference."""

    yaw_rate: float = entry(unit="rad/s", about="wanted yaw rate, filtered")


class Wanted(NamedTuple):
    """Wanted motion of the car."""

    yaw_rate: float  # [rad/s]
    rate: float  # of the yaw rate [rad/s^2]
    angle: float  # at which a car of the linear part yaws so [rad]


class Bend(NamedTuple):
    """Motion of the car from which the driver's wanted bend is read."""

    speed: float  # not zero, negative in reverse [m/s]
    road_wheel_angle: float  # [rad]
    grip: float  # lateral acceleration that the believed friction allows [m/s^2]
    lateral_acceleration: float  # measured [m/s^2]
    rear_sideslip: float  # slip angle of the rear axle [rad]


@compilable
def wanted_motion(
    p: ReferenceParameters,
    car: Car,
    s: ReferenceState,
    period: float,
    kind: Reference,
    bend: Bend,
) -> Wanted:
    """Wanted yaw rate, by the acceleration a that the characteristic gives.

    r* = sgn(u delta) a(|delta|)/|u|; with a sideslip limit r* + w (a_y/u - r*), where w grows from
    0 to 1 between `first_sideslip` and `last_sideslip` of the rear axle [rad].
    """
    speed = bend.speed
    u = abs(bend.speed)
    angle = abs(bend.road_wheel_angle)
    # Never zero: the characteristic divides by it.
    largest = p.grip_share * max(bend.grip, LEAST_GRIP)
    gradient = 0.0 if kind == Reference.NEUTRAL else p.gradient
    straight = car.wheelbase / (u * u)
    if kind == Reference.NEUTRAL:
        acceleration = min(angle / straight, largest)
    else:
        acceleration = designed_acceleration(p, straight, angle, largest)
    yaw_rate = copysign(acceleration / u, bend.road_wheel_angle * speed)
    if kind == Reference.SIDESLIP_LIMIT:
        beyond = abs(bend.rear_sideslip) - p.first_sideslip
        weight = min(max(beyond / (p.last_sideslip - p.first_sideslip), 0.0), 1.0)
        yaw_rate += weight * (bend.lateral_acceleration / speed - yaw_rate)
    # The lag gives the rate that the feed-forward needs, without a derivative.
    change = filter_share(period, p.lag) * (yaw_rate - s.yaw_rate)
    s.yaw_rate += change
    # r = u delta/(L + K u^2), solved for delta.
    angle_of_linear_car = s.yaw_rate * (car.wheelbase + gradient * u * u) / speed
    return Wanted(s.yaw_rate, change / period, angle_of_linear_car)


@compilable
def designed_acceleration(
    p: ReferenceParameters, straight: float, angle: float, largest: float
) -> float:
    """Lateral acceleration a [m/s^2] at which delta = L a/u^2 + d(a), for an angle of at least 0.

    With y = d(a) it is the root of y + a(y) L/u^2 - delta, which is concave in y: from y = 0
    Newton's steps rise to it and never pass it. `straight` is L/u^2 [s^2/m], `largest` bounds a.
    """
    linear = p.linear_share * largest
    y = acceleration = 0.0
    for _ in range(_ROUNDS):
        if y <= p.gradient * linear:
            acceleration = y / p.gradient
            slope = 1.0 / p.gradient
        else:
            scale = (largest - linear) * p.gradient
            left = (largest - linear) * exp((p.gradient * linear - y) / scale)
            acceleration = largest - left
            slope = left / scale
        # Newton on a concave function: no step passes the root, so the first small one ends it.
        step = (angle - y - straight * acceleration) / (1.0 + straight * slope)
        y += step
        if step <= _CLOSE:
            break
    return acceleration
