"""The estimators over a record of a real car, instant by instant, as `validate --estimators` holds them against it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ev_control.estimation.reference_speed import ReferenceSpeedParameters, ReferenceSpeedState, rolling_speeds
from ev_control.estimation.slip_angle_observer import (
    SlipAngleObserverParameters,
    SlipAngleObserverState,
    slip_angles_at,
)
from ev_core.law import WHEEL_NAMES, InertialMeasurement, Wheels
from ev_core.methods.estimator import Estimator

_SPEED, _YAW_RATE, _ANGLE = "twist.longitudinal", "twist.yaw_rate", "steering_column.state.road_wheel_angle"
_ALONG, _ACROSS, _DRIVE = "imu.longitudinal_acceleration", "imu.lateral_acceleration", "driver.command.drive_torque"
_WHEELS = tuple(f"wheel_states.velocity.{wheel}" for wheel in WHEEL_NAMES)

Given = Mapping[str, np.ndarray]


def _instants(given: Given, *channels: str) -> Iterator[tuple[float, ...]]:
    return zip(*(given[channel].tolist() for channel in channels), strict=True)


def sideslip(p: Any, car: Any, period: float, given: Given) -> np.ndarray:
    """Sideslip angle [rad] by the slip-angle observer at the measured speed; in reverse that of the rear."""
    s = SlipAngleObserverState()
    lateral = []
    for speed, across, yaw_rate, angle in _instants(given, _SPEED, _ACROSS, _YAW_RATE, _ANGLE):
        slip_angles_at(p, car, s, period, p.kinematic_share, speed, across, yaw_rate, angle)
        lateral.append(s.lateral_velocity)
    ahead = np.where(given[_SPEED] < 0.0, -1.0, 1.0)
    estimated: np.ndarray = np.arctan2(ahead * np.array(lateral), ahead * given[_SPEED])
    return estimated


def speed(p: Any, car: Any, period: float, given: Given) -> np.ndarray:
    """Speed of the car [m/s] that slip is counted against; without a drive torque the wheels are taken to roll."""
    s = ReferenceSpeedState()
    direction = np.sign(given.get(_DRIVE, np.zeros(len(given[_ANGLE])))).tolist()
    found = []
    signals = _instants(given, *_WHEELS, _ALONG, _ACROSS, _YAW_RATE, _ANGLE)
    for sign, (one, two, three, four, along, across, yaw_rate, angle) in zip(direction, signals, strict=True):
        imu = InertialMeasurement(yaw_rate, along, across)
        rolling_speeds(p, car, s, period, Wheels(one, two, three, four), angle, imu, sign)
        found.append(s.speed)
    return np.array(found)


ESTIMATORS = {
    "slip_angle_observer": Estimator(
        SlipAngleObserverParameters, (_SPEED, _ACROSS, _YAW_RATE, _ANGLE), (), "sideslip", sideslip
    ),
    "reference_speed": Estimator(
        ReferenceSpeedParameters, (*_WHEELS, _ALONG, _ACROSS, _YAW_RATE, _ANGLE), (_DRIVE,), _SPEED, speed
    ),
}
