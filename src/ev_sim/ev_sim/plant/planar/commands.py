"""The guard before the integrator: only finite commands within range pass, everything else is counted."""

from __future__ import annotations

import math
from operator import ge, le

from ev_msgs_py.signals import SteeringColumnState, WheelTorqueCommand
from ev_msgs_py.vehicle import Vehicle
from ev_msgs_py.wheels import NO_WHEELS, WHEEL_NAMES


class CommandGuard:
    """Make any command safe to integrate.

    A drive torque that is not finite becomes 0; a brake torque or a steering angle that is not finite keeps its last
    accepted value. Values out of range go to the nearest end of it; a wheel without a motor has
    no range. `non_finite` and `out_of_range` count the values
    concerned.
    """

    def __init__(self, vehicle: Vehicle, motor_torque: float):
        """`motor_torque` [N m] is the largest at the shaft of one motor; coupled wheels may get that of all motors."""
        motors = 1 if vehicle.driveline.coupling == "individual" else len(vehicle.driven_wheels)
        limit = motor_torque * vehicle.gear_ratio * motors
        self.drive_limit = tuple(limit if name in vehicle.driven_wheels else 0.0 for name in WHEEL_NAMES)
        self._drive_low = tuple(-limit for limit in self.drive_limit)
        self.brake_limit = vehicle.maximum_brake_torque
        self.angle_limit = vehicle.maximum_road_wheel_angle
        self.non_finite = 0
        self.out_of_range = 0
        self._brake: tuple[float, ...] = NO_WHEELS
        self._angle = 0.0

    def accept(
        self, command: WheelTorqueCommand, column: SteeringColumnState, period: float
    ) -> tuple[tuple[float, ...], tuple[float, ...], float, float]:
        """Drive and brake torques [N m], road-wheel angle [rad] and rate [rad/s] that may be held over a period [s]."""
        drive, brake, angle, rate = command.drive, command.brake, column.road_wheel_angle, column.road_wheel_rate
        most = self.angle_limit
        if (
            all(map(le, drive, self.drive_limit))
            and all(map(ge, drive, self._drive_low))
            and min(brake) >= 0.0
            and max(brake) <= self.brake_limit
            and sum(brake) < math.inf  # neither min nor max shows every NaN
            and -most <= angle <= most
            and -most <= angle + rate * period <= most
        ):
            self._brake, self._angle = brake, angle
            return drive, brake, angle, rate
        return self._mended(command, column, period)

    def _mended(
        self, command: WheelTorqueCommand, column: SteeringColumnState, period: float
    ) -> tuple[tuple[float, ...], tuple[float, ...], float, float]:
        """The same for a command of which something is not finite or out of range."""
        drive = tuple(
            self._value(value, 0.0, -limit, limit) for value, limit in zip(command.drive, self.drive_limit, strict=True)
        )
        self._brake = tuple(
            self._value(value, last, 0.0, self.brake_limit)
            for value, last in zip(command.brake, self._brake, strict=True)
        )
        self._angle = self._value(column.road_wheel_angle, self._angle, -self.angle_limit, self.angle_limit)
        # The angle at the end of the period stays within its limit, too.
        rate = self._value(
            column.road_wheel_rate,
            0.0,
            (-self.angle_limit - self._angle) / period,
            (self.angle_limit - self._angle) / period,
        )
        return drive, self._brake, self._angle, rate

    def _value(self, value: float, otherwise: float, low: float, high: float) -> float:
        if not math.isfinite(value):
            self.non_finite += 1
            return otherwise
        if low <= value <= high:
            return float(value)
        self.out_of_range += 1
        return low if value < low else high
