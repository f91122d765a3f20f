"""Rewards of the environments: simple, and bounded below by the worst that a car can do.

A reward that is marked as `compilable` is written as a law is: it names what it needs of `car`,
`action` and `own`, the action that stands for what the scenario's own law wrote at the same
instant, then signals by their annotations, those of the instant after the step (`judging`). A
signal that no role of the scenario writes is 0.
"""

from __future__ import annotations

from collections.abc import Sequence

from ev_core.vehicle.car import Car
from ev_msgs_py.compilable import compilable
from ev_msgs_py.contract.optional_signals import RearSteeringState
from ev_msgs_py.contract.signals import (
    BodyVelocity,
    InertialMeasurement,
    SteeringColumnState,
    TireForces,
)

# [m/s^2], of the lateral acceleration that is not the one of a neutral car
LARGE_YAW_ACCELERATION = 1.0
LARGE_SLIP_RATIO = 0.1  # about where tyres on snow and wet roads give most
LARGE_DIFFERENCE = 1.0  # [N m], of hand torques


@compilable
def calm_yaw(
    car: Car,
    body: BodyVelocity,
    column: SteeringColumnState,
    imu: InertialMeasurement,
    rear_steering: RearSteeringState,
    tyres: TireForces,
) -> float:
    """Minus the squared yaw rate error against a neutral car, times speed, and the squared slip.

    A neutral car turns by V/L tan(delta) = V delta/L for the angles of driving, where delta is that
    of the front wheels less that of the rear ones.
    """
    front = column.angle / car.steering_ratio
    # A rear axle that is steered by a law of its own adds to what follows the front wheels.
    rear = car.rear_steering_ratio * front + rear_steering.angle
    neutral = body.longitudinal * (front - rear) / car.wheelbase
    # V times a yaw rate is a lateral acceleration, which weighs the error by what it does to
    # the path.
    error = body.longitudinal * (imu.yaw_rate - neutral) / LARGE_YAW_ACCELERATION
    return -error * error + little_slip(tyres)


@compilable
def little_slip(tyres: TireForces) -> float:
    """Minus the square of the largest slip ratio; 0 for a plant without slip."""
    slip = tyres.slip_ratio
    front = max(abs(slip[0]), abs(slip[1]))
    rear = max(abs(slip[2]), abs(slip[3]))
    ratio = max(front, rear) / LARGE_SLIP_RATIO
    return -ratio * ratio


@compilable
def quick_without_slip(imu: InertialMeasurement, tyres: TireForces) -> float:
    """Acceleration [m/s^2] beside the slip that it costs."""
    return imu.longitudinal_acceleration + little_slip(tyres)


@compilable
def like_the_driver(action: Sequence[float], own: Sequence[float]) -> float:
    """Minus the squared distance to the hand torque of the scenario's own driver."""
    difference = (action[0] - own[0]) / LARGE_DIFFERENCE
    return -difference * difference


@compilable
def never() -> bool:
    """Mark of the end of an episode: none ends early."""
    return False
