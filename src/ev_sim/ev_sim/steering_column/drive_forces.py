"""The moment of the two front drives about the steering axes (eqs 1 and 3 of Shchur 2019)."""

from __future__ import annotations

from ev_msgs_py.signals import WheelStates
from ev_msgs_py.vehicle import Vehicle


class DriveForceDifference:
    """Steering moment of the drive forces: d/(2 r_k) (M_R - M_L) - J_k d/(2 r_k) (w_R' - w_L').

    The torques are the actual ones at the wheels. The wheel accelerations of a period are the difference of the
    speeds at its two ends before, so they come one period late: the column reads no later speed.
    """

    def __init__(self, wheel_inertia: float, vehicle: Vehicle, period: float) -> None:
        self._lever = vehicle.front_track / (2 * vehicle.wheel_radius)
        self._inertia_over_period = wheel_inertia / period

    @staticmethod
    def speed_difference(wheels: WheelStates) -> float:
        """Right minus left front wheel speed [rad/s]."""
        return wheels.velocity.front_right - wheels.velocity.front_left

    def moment(self, wheels: WheelStates, last_speed_difference: float) -> float:
        """Moment about the steering axes, left positive [N m], from the wheels and the speeds a period before."""
        torque_difference = wheels.effort.front_right - wheels.effort.front_left
        acceleration_torque = self._inertia_over_period * (self.speed_difference(wheels) - last_speed_difference)
        return self._lever * (torque_difference - acceleration_torque)
