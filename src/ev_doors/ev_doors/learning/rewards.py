"""Rewards of the environments: simple, and bounded below by the worst that a car can do.

A reward is a function of the frame after the step, the action, and the action that stands for what
the scenario's own law wrote at the same instant.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from ev_msgs_py.contract.wheels import WHEEL_NAMES

Reward = Callable[[Mapping[str, float], np.ndarray, np.ndarray], float]

# [m/s^2], of the lateral acceleration that is not the one of a neutral car
LARGE_YAW_ACCELERATION = 1.0
LARGE_SLIP_RATIO = 0.1  # about where tyres on snow and wet roads give most
LARGE_DIFFERENCE = 1.0  # [N m], of hand torques


@dataclass(frozen=True)
class CalmYaw:
    """Minus the squared yaw rate error against a neutral car, times speed, and the squared slip.

    A neutral car turns by V/L tan(delta) = V delta/L for the angles of driving, where delta is that
    of the front wheels less that of the rear ones.
    """

    wheelbase: float
    steering_ratio: float
    rear_steering_ratio: float = 0.0

    def __call__(self, frame: Mapping[str, float], action: np.ndarray, own: np.ndarray) -> float:
        """The reward."""
        speed = frame["twist.longitudinal"]
        front = frame["steering_column.state.angle"] / self.steering_ratio
        # A rear axle that is steered by a law of its own adds to what follows the front wheels.
        rear = self.rear_steering_ratio * front + frame.get("rear_steering.state.angle", 0.0)
        neutral = speed * (front - rear) / self.wheelbase
        # V times a yaw rate is a lateral acceleration, which weighs the error by what it does to
        # the path.
        error = speed * (frame["imu.yaw_rate"] - neutral) / LARGE_YAW_ACCELERATION
        return -error * error + little_slip(frame, action, own)


def little_slip(frame: Mapping[str, float], action: np.ndarray, own: np.ndarray) -> float:
    """Minus the square of the largest slip ratio; 0 for a plant without slip."""
    slips = [abs(frame.get(f"tire_forces.slip_ratio.{wheel}", 0.0)) for wheel in WHEEL_NAMES]
    ratio = max(slips) / LARGE_SLIP_RATIO
    return -ratio * ratio


def quick_without_slip(frame: Mapping[str, float], action: np.ndarray, own: np.ndarray) -> float:
    """Acceleration [m/s^2] beside the slip that it costs."""
    return frame["imu.longitudinal_acceleration"] + little_slip(frame, action, own)


def like_the_driver(frame: Mapping[str, float], action: np.ndarray, own: np.ndarray) -> float:
    """Minus the squared distance to the hand torque of the scenario's own driver."""
    difference = float(action[0] - own[0]) / LARGE_DIFFERENCE
    return -difference * difference
