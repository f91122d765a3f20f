"""What all traction controls share: whom they limit, when they keep out of it, and what they measure."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

from ev_control.reference_speed import ReferenceSpeed, ReferenceSpeedParameters, ReferenceSpeedState
from ev_msgs_py.signals import (
    InertialMeasurement,
    SteeringColumnState,
    WheelStates,
    WheelTorqueCommand,
    WheelTorqueRequest,
)
from ev_msgs_py.vehicle import Vehicle
from ev_msgs_py.wheels import WHEEL_NAMES, Wheels

# Beyond these a number is no measurement of a road vehicle: 3 km/s at the tyre, a hundred motors, a collision.
_LARGEST_SPEED = 1e4  # [rad/s]
_LARGEST_TORQUE = 1e6  # [N m]
_LARGEST_ACCELERATION = 1e3  # [m/s^2]
_LARGEST_YAW_RATE = 1e2  # [rad/s]
_LARGEST_ANGLE = 1.5  # [rad]

# Slower than this against the request, a car is not braked by its drives but about to pull away, perhaps on a hill.
_PULLING_AWAY = 0.3  # [m/s]


@dataclass(slots=True)
class LimitedWheel:
    """What a traction control knows of one driven wheel: the largest torque that it gets [N m]."""

    limit: float = math.inf


@dataclass(slots=True)
class TractionControlState:
    """Reference speed, last wheel speeds [rad/s], direction of the request by driven wheel, and what the law knows."""

    reference: ReferenceSpeedState
    velocity: Wheels | None
    direction: list[float]
    wheels: list[Any]


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

    def slip(self, slowest: float) -> float:
        """Slip 1 - w_free/w (dissertation, eq 2.34) [1], against at least `slowest` [rad/s], so that rest is none."""
        return (self.speed - self.rolling) / max(abs(self.speed), slowest)


class TractionControl(ABC):
    """A limit for the drive torque of each driven wheel, which never adds torque and never turns its sign.

    Torques pass unchanged, and the law forgets the wheel, where nothing is asked for, where any wheel is braked, and
    where a torque works against the travel of the car (regeneration). Everything is counted in the direction of the
    request, so reverse mirrors forward. A measurement that is not finite or absurd changes nothing: the last limits
    stay. `_limit` of a law gives the largest torque of one wheel, or infinity.
    """

    def __init__(
        self, law: str, new: Callable[[], Any], reference: ReferenceSpeedParameters, vehicle: Vehicle, period: float
    ) -> None:
        self._new_wheel = new
        self._period = period
        self._driven = [i for i, name in enumerate(WHEEL_NAMES) if name in vehicle.driven_wheels]
        self._reference = ReferenceSpeed(reference, vehicle, period, law)
        count = len(self._driven)
        self.state = TractionControlState(self._reference.state, None, [0.0] * count, [new() for _ in range(count)])

    def step(
        self,
        request: WheelTorqueRequest,
        column: SteeringColumnState,
        wheels: WheelStates,
        imu: InertialMeasurement,
    ) -> WheelTorqueCommand:
        """The requested torques [N m], those of slipping wheels limited."""
        s, drive = self.state, request.drive
        if not is_plausible(column, wheels, imu):
            s.velocity = None
            return _limited(request, self._driven, [wheel.limit for wheel in s.wheels])
        asked = drive[0] + drive[1] + drive[2] + drive[3]
        direction = (asked > 0.0) - (asked < 0.0)
        braked = any(request.brake)
        if braked:
            direction = (s.reference.speed < 0.0) - (s.reference.speed > 0.0)
        self._reference.state = s.reference
        rolling = self._reference.rolling_speeds(wheels.velocity, column.road_wheel_angle, imu, direction)
        if braked or not any(drive):
            for place in range(len(self._driven)):
                self._turn(place, 0.0)
            limits = None
        else:
            limits = self._limits(drive, wheels, rolling, imu)
        s.velocity = wheels.velocity
        return _limited(request, self._driven, limits)

    def _turn(self, place: int, ahead: float) -> None:
        """Note the direction of the request of a driven wheel, which is forgotten where that is another one."""
        s = self.state
        if ahead != s.direction[place]:
            s.direction[place] = ahead
            s.wheels[place] = self._new_wheel()

    def _limits(
        self, drive: Wheels, wheels: WheelStates, rolling: tuple[float, float, float, float], imu: InertialMeasurement
    ) -> list[float]:
        """The largest torque of each driven wheel [N m]."""
        s, limits = self.state, []
        velocity, effort = wheels.velocity, wheels.effort
        before = s.velocity or velocity
        for place, i in enumerate(self._driven):
            wanted = drive[i]
            ahead = 1.0 if wanted > 0.0 else -1.0
            if wanted == 0.0 or ahead * s.reference.speed < -_PULLING_AWAY:
                ahead = 0.0
            self._turn(place, ahead)
            if ahead == 0.0:
                limits.append(math.inf)
                continue
            motion = WheelMotion(
                ahead * velocity[i],
                ahead * rolling[i],
                ahead * (velocity[i] - before[i]) / self._period,
                ahead * effort[i],
                ahead * imu.longitudinal_acceleration,
                imu.longitudinal_acceleration,
                imu.lateral_acceleration,
                i,
            )
            wheel = s.wheels[place]
            wheel.limit = limit = max(self._limit(wheel, motion, abs(wanted)), 0.0)
            limits.append(limit)
        return limits

    @abstractmethod
    def _limit(self, wheel: Any, motion: WheelMotion, wanted: float) -> float:
        """The largest torque of a wheel [N m] of which `wanted` [N m], above zero, is asked; goes on with its state."""


def _limited(request: WheelTorqueRequest, driven: list[int], limits: list[float] | None) -> WheelTorqueCommand:
    """The request with the drive torques of the driven wheels within their limits [N m], if there are any."""
    drive, brake = request
    if limits is None:
        return WheelTorqueCommand(drive, brake)
    allowed = list(drive)
    for i, limit in zip(driven, limits, strict=True):
        if abs(drive[i]) > limit:
            allowed[i] = math.copysign(limit, drive[i])
    return WheelTorqueCommand(Wheels(*allowed), brake)


def is_plausible(column: SteeringColumnState, wheels: WheelStates, imu: InertialMeasurement) -> bool:
    """Whether all that is measured is finite and could be a road vehicle's."""
    return (
        math.hypot(*wheels.velocity) < _LARGEST_SPEED
        and math.hypot(*wheels.effort) < _LARGEST_TORQUE
        and math.hypot(imu.longitudinal_acceleration, imu.lateral_acceleration) < _LARGEST_ACCELERATION
        and abs(imu.yaw_rate) < _LARGEST_YAW_RATE
        and abs(column.road_wheel_angle) < _LARGEST_ANGLE
    )
