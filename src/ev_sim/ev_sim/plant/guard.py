"""The guard before the integrator: only finite commands within range pass, others are counted.

A drive torque or a steering rate that is not finite becomes 0; a brake torque or a steering angle
that is not finite keeps its last accepted value. Values out of range go to the nearest end of it; a
wheel without a motor has no range.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from ev_core.law import WHEEL_NAMES, Vehicle, Wheels, compilable, entry, isfinite, per_wheel
from ev_core.vehicle.driveline import drive_train_numbers, motors_behind
from ev_msgs_py.contract.signals import SteeringColumnState, WheelTorqueCommand


class Commanded(NamedTuple):
    """Signals that every plant reads: torques of the wheels, and the steering column."""

    torques: WheelTorqueCommand
    column: SteeringColumnState


class GuardLimits(NamedTuple):
    """Largest drive and brake torques at the wheels [N m] and road-wheel angle [rad].

    Drive and angle hold either way.
    """

    drive: Wheels
    brake: float
    angle: float


@dataclass(slots=True)
class GuardState:
    """Values that were accepted last, and numbers of those that were not taken as they came."""

    brake: list[float] = per_wheel(unit="N m", about="brake torque that was accepted last")
    angle: float = entry(unit="rad", about="road-wheel angle that was accepted last")
    non_finite: float = entry(unit="1", about="number of values that were not finite")
    out_of_range: float = entry(unit="1", about="number of values that were out of range")


def guard_limits(vehicle: Vehicle, motor_torque: float, angle: float) -> GuardLimits:
    """Limits of a car by the largest torque at the shaft of one motor [N m].

    `angle` is the largest road-wheel angle [rad]. Coupled wheels may get the torque of all motors.
    """
    gears = drive_train_numbers(vehicle)["gear"]
    limits = (
        motor_torque * gear * motors_behind(vehicle, name)
        for name, gear in zip(WHEEL_NAMES, gears, strict=True)
    )
    drive = Wheels(
        *(
            limit if name in vehicle.driven_wheels else 0.0
            for name, limit in zip(WHEEL_NAMES, limits, strict=True)
        )
    )
    return GuardLimits(drive, vehicle.maximum_brake_torque, angle)


@compilable
def guarded_torques(
    limits: GuardLimits, guard: GuardState, command: WheelTorqueCommand
) -> WheelTorqueCommand:
    """Drive and brake torques of the wheels that may be held over a period [N m]."""
    torques, most = command.drive, limits.drive
    drive = Wheels(
        accepted(guard, torques[0], 0.0, -most[0], most[0]),
        accepted(guard, torques[1], 0.0, -most[1], most[1]),
        accepted(guard, torques[2], 0.0, -most[2], most[2]),
        accepted(guard, torques[3], 0.0, -most[3], most[3]),
    )
    for i in range(4):
        guard.brake[i] = accepted(guard, command.brake[i], guard.brake[i], 0.0, limits.brake)
    return WheelTorqueCommand(
        drive, Wheels(guard.brake[0], guard.brake[1], guard.brake[2], guard.brake[3])
    )


@compilable
def guarded_angle(limits: GuardLimits, guard: GuardState, column: SteeringColumnState) -> float:
    """Road-wheel angle at the beginning of a period [rad]."""
    guard.angle = accepted(guard, column.road_wheel_angle, guard.angle, -limits.angle, limits.angle)
    return guard.angle


@compilable
def guarded_steering(
    limits: GuardLimits, guard: GuardState, column: SteeringColumnState, period: float
) -> tuple[float, float]:
    """Road-wheel angle [rad], and the rate [rad/s] at which it may go on over a period [s]."""
    angle, limit = guarded_angle(limits, guard, column), limits.angle
    # At most the rate that reaches the limit of the angle at the end of the period.
    low, high = (-limit - angle) / period, (limit - angle) / period
    return angle, accepted(guard, column.road_wheel_rate, 0.0, low, high)


@compilable
def accepted(guard: GuardState, value: float, otherwise: float, low: float, high: float) -> float:
    """A value within its range; `otherwise` if it is not finite."""
    # NaN fails both comparisons, so one test lets all good values pass.
    if low <= value <= high:
        return value
    if not isfinite(value):
        guard.non_finite += 1.0
        return otherwise
    guard.out_of_range += 1.0
    return low if value < low else high


def guard_notes(guard: GuardState) -> tuple[str, ...]:
    """Lines about values that were not taken as they came, counted by powers of ten."""
    counts = (
        ("values of commands were not finite", int(guard.non_finite)),
        ("values of commands were out of range", int(guard.out_of_range)),
    )
    return tuple(f"{10 ** (len(str(count)) - 1)} or more {what}" for what, count in counts if count)
