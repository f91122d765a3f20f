"""The moment of the two front drives about the steering axes (eqs 1 and 3 of Shchur 2019)."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.signals import WheelStates
from ev_msgs_py.vehicle.car import Car


@compilable
def speed_difference(wheels: WheelStates) -> float:
    """Right minus left front wheel speed [rad/s]."""
    return wheels.velocity.front_right - wheels.velocity.front_left


@compilable
def drive_moment(
    car: Car, wheel_inertia: float, period: float, wheels: WheelStates, last_speed_difference: float
) -> float:
    """Steering moment of the drive forces, left positive [N m]: d/(2 r_k) (M_R - M_L) - J_k d/(2 r_k) (w_R' - w_L').

    The torques are the actual ones at the wheels. The wheel accelerations of a period are the difference of the
    speeds at its two ends before, so they come one period late: the column reads no later speed.
    """
    lever = car.front_track / (2 * car.wheel_radius)
    torque_difference = wheels.effort.front_right - wheels.effort.front_left
    acceleration_torque = wheel_inertia / period * (speed_difference(wheels) - last_speed_difference)
    return lever * (torque_difference - acceleration_torque)
