"""The guard before the integrator: only finite commands within range pass, everything else is counted."""

from __future__ import annotations

import math

from ev_msgs_py.signals import SteeringColumnState, WheelTorqueCommand
from ev_msgs_py.vehicle import Vehicle
from ev_msgs_py.wheels import NO_WHEELS, WHEEL_NAMES


class CommandGuard:
    """Make any command safe to integrate.

    A drive torque or a steering rate that is not finite becomes 0; a brake torque or a steering angle that is not
    finite keeps its last accepted value. Values out of range go to the nearest end of it; a wheel without a motor has
    no range. `non_finite` and `out_of_range` count the values concerned.
    """

    def __init__(self, vehicle: Vehicle, motor_torque: float, angle_limit: float):
        """Largest torque at the shaft of one motor [N m] and largest road-wheel angle [rad], either way.

        Coupled wheels may get the torque of all motors.
        """
        motors = 1 if vehicle.driveline.coupling == "individual" else len(vehicle.driven_wheels)
        limit = motor_torque * vehicle.gear_ratio * motors
        self.drive_limit = tuple(limit if name in vehicle.driven_wheels else 0.0 for name in WHEEL_NAMES)
        self.brake_limit = vehicle.maximum_brake_torque
        self.angle_limit = angle_limit
        self.non_finite = 0
        self.out_of_range = 0
        self._brake: tuple[float, ...] = NO_WHEELS
        self._angle = 0.0

    def torques(self, command: WheelTorqueCommand) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Drive and brake torques of the wheels that may be held over a period [N m]."""
        drive, brake = command.drive, command.brake
        d_1, d_2, d_3, d_4 = drive
        b_1, b_2, b_3, b_4 = brake
        l_1, l_2, l_3, l_4 = self.drive_limit
        most = self.brake_limit
        if (
            (-l_1 <= d_1 <= l_1 and -l_2 <= d_2 <= l_2 and -l_3 <= d_3 <= l_3 and -l_4 <= d_4 <= l_4)
            and (0.0 <= b_1 <= most and 0.0 <= b_2 <= most and 0.0 <= b_3 <= most and 0.0 <= b_4 <= most)
        ):  # fmt: skip
            self._brake = brake
            return drive, brake
        drive = tuple(
            self._value(value, 0.0, -limit, limit) for value, limit in zip(command.drive, self.drive_limit, strict=True)
        )
        self._brake = tuple(
            self._value(value, last, 0.0, self.brake_limit)
            for value, last in zip(command.brake, self._brake, strict=True)
        )
        return drive, self._brake

    def angle(self, column: SteeringColumnState) -> float:
        """Road-wheel angle at the beginning of a period [rad]."""
        self._angle = self._value(column.road_wheel_angle, self._angle, -self.angle_limit, self.angle_limit)
        return self._angle

    def steering(self, column: SteeringColumnState, period: float) -> tuple[float, float]:
        """The angle as above, and the rate [rad/s] at which it may go on over a period [s] within its limit."""
        angle, limit = self.angle(column), self.angle_limit
        return angle, self._value(column.road_wheel_rate, 0.0, (-limit - angle) / period, (limit - angle) / period)

    @property
    def refused(self) -> int:
        """How many values were not taken as they came."""
        return self.non_finite + self.out_of_range

    def reports(self) -> tuple[str, ...]:
        """What was not taken as it came, counted by powers of ten."""
        counts = (
            ("values of commands were not finite", self.non_finite),
            ("values of commands were out of range", self.out_of_range),
        )
        return tuple(f"{10 ** (len(str(count)) - 1)} or more {what}" for what, count in counts if count)

    @property
    def diagnostics(self) -> dict[str, float]:
        """Counts of values that were not taken as they came."""
        return {"non_finite_commands": self.non_finite, "out_of_range_commands": self.out_of_range}

    def _value(self, value: float, otherwise: float, low: float, high: float) -> float:
        if low <= value <= high:
            return float(value)
        if not math.isfinite(value):
            self.non_finite += 1
            return otherwise
        self.out_of_range += 1
        return low if value < low else high
