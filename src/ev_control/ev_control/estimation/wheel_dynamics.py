"""The spinning wheel as traction control sees it: its motion, its slip, and the torque that the road takes from it."""

from __future__ import annotations

from typing import Any, NamedTuple

from ev_core.law import Car, compilable, parameter


class WheelMotion(NamedTuple):
    """What is measured of one wheel, counted positive in the direction of its request."""

    speed: float  # [rad/s]
    rolling: float  # speed at which it would roll [rad/s]
    acceleration: float  # mean over the last period, not filtered [rad/s^2]
    torque: float  # mean over the last period [N m]
    body_acceleration: float  # of the car [m/s^2]
    forward_acceleration: float  # of the car to its front, in reverse as well [m/s^2]
    lateral_acceleration: float  # of the car to its left [m/s^2]
    place: int  # of the wheel, in the order of Wheels
    ahead: float  # 1 if the request is to the front, -1 in reverse
    car_speed: float  # to its front [m/s]
    yaw_rate: float  # [rad/s]
    road_wheel_angle: float  # mean of the front wheels [rad]


def slowest_wheel() -> Any:
    """The parameter `slowest` of those that take a slip by `slip_of`."""
    return parameter(
        3.0,
        unit="rad/s",
        low=0.1,
        high=100.0,
        about="wheel speed below which slip is counted against this speed, so that rest is no slip",
    )


def share_at_rest(share: float) -> Any:
    """The parameter `at_rest` of those that take a share of their slips by `share_at`."""
    return parameter(
        share,
        unit="1",
        low=0.01,
        high=1.0,
        about="share of the wanted slip that a limited wheel has at rest; from `slowest` on it is whole. With 1 a "
        "tread that slides by slip times `slowest` passes as one that grips, and the car stands on a slippery hill",
    )


@compilable
def share_at(motion: WheelMotion, slowest: float, at_rest: float) -> float:
    """The share [1] of a wanted slip at the speed of the car: `at_rest`, and all of it from `slowest` [rad/s] on."""
    return at_rest + (1.0 - at_rest) * min(abs(motion.rolling) / slowest, 1.0)


@compilable
def slip_of(motion: WheelMotion, slowest: float) -> float:
    """Slip 1 - w_free/w (dissertation, eq 2.34) [1], against at least `slowest` [rad/s], so that rest is none."""
    return (motion.speed - motion.rolling) / max(abs(motion.speed), slowest)


@compilable
def road_torque(car: Car, motion: WheelMotion) -> float:
    """Torque that the road takes from a wheel, M - J w' [N m], mean over the last period, not filtered."""
    return motion.torque - car.driven_wheel_inertia[motion.place] * motion.acceleration


@compilable
def mass_share(car: Car) -> float:
    """The part of the car's mass that one driven wheel has to move [kg]; the source's M is that of a single wheel."""
    return car.mass / max(car.number_driven, 1.0)
