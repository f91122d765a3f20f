"""Longitudinal speed of a rear-driven car from its free-rolling front wheels."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.wheels import Wheels
from ev_msgs_py.elementary import cos, sin
from ev_msgs_py.vehicle.car import Car


@compilable
def free_wheel_speed(car: Car, wheel_velocity: Wheels, road_wheel_angle: float, yaw_rate: float) -> float:
    """Longitudinal velocity of the centre of mass [m/s] from front wheels that roll without slip.

    The middle of the front axle moves with R (w_1 + w_2)/2 = u cos(delta) + (v + a r) sin(delta) along the wheels, and
    the rear axle is taken to move straight ahead, v = b r, so u = (R (w_1 + w_2)/2 - L r sin(delta))/cos(delta). Wheel
    velocities [rad/s], angle left positive [rad], yaw rate [rad/s]. A slip angle d of the rear axle leaves the error
    u tan(delta) sin(d), 0.1 % at 2 deg each. An assumption of this project, no source has it.
    """
    rolling = car.wheel_radius * (wheel_velocity.front_left + wheel_velocity.front_right) / 2.0
    turning = car.wheelbase * yaw_rate * sin(road_wheel_angle)
    return (rolling - turning) / cos(road_wheel_angle)
