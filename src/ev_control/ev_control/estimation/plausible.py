"""What no road vehicle does, and therefore no sensor may be believed."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.signals import InertialMeasurement, SteeringColumnState, WheelStates
from ev_msgs_py.contract.wheels import Wheels

# Beyond these a number is no measurement of a road vehicle: 3 km/s at the tyre, a hundred motors, a collision.
LARGEST_SPEED = 1e4  # [rad/s]
LARGEST_TORQUE = 1e6  # [N m]
LARGEST_ACCELERATION = 1e3  # [m/s^2]
LARGEST_YAW_RATE = 1e2  # [rad/s]
LARGEST_ANGLE = 1.5  # [rad]


@compilable
def is_plausible(column: SteeringColumnState, wheels: WheelStates, imu: InertialMeasurement) -> bool:
    """Whether all that is measured is finite and could be a road vehicle's."""
    along, across = imu.longitudinal_acceleration, imu.lateral_acceleration
    return (
        sum_of_squares(wheels.velocity) < LARGEST_SPEED * LARGEST_SPEED
        and sum_of_squares(wheels.effort) < LARGEST_TORQUE * LARGEST_TORQUE
        and along * along + across * across < LARGEST_ACCELERATION * LARGEST_ACCELERATION
        and abs(imu.yaw_rate) < LARGEST_YAW_RATE
        and abs(column.road_wheel_angle) < LARGEST_ANGLE
    )


@compilable
def sum_of_squares(of: Wheels) -> float:
    """Left and right first, so that a mirrored car gets the same number."""
    return (of[0] * of[0] + of[1] * of[1]) + (of[2] * of[2] + of[3] * of[3])
