"""Estimators over a record of a real car, instant by instant, for `validate --estimators`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ev_control.estimation.plausible import Sensors
from ev_control.estimation.reference_speed import (
    ReferenceSpeedParameters,
    ReferenceSpeedState,
    rolling_speeds,
)
from ev_control.estimation.slip_angle_observer import (
    SlipAngleObserverParameters,
    SlipAngleObserverState,
    Turn,
    slip_angles_at,
)
from ev_core.law import (
    NO_WHEELS,
    WHEEL_NAMES,
    InertialMeasurement,
    SteeringColumnState,
    Wheels,
    WheelStates,
)
from ev_core.methods.estimator import Estimator

_SPEED = "twist.longitudinal"
_YAW_RATE = "twist.yaw_rate"
_ANGLE = "steering_column.state.road_wheel_angle"
_ALONG = "imu.longitudinal_acceleration"
_ACROSS = "imu.lateral_acceleration"
_DRIVE = "driver.command.drive_torque"
_WHEELS = tuple(f"wheel_states.velocity.{wheel}" for wheel in WHEEL_NAMES)

Given = Mapping[str, np.ndarray]


def _instants(given: Given, *channels: str) -> Iterator[tuple[float, ...]]:
    return zip(*(given[channel].tolist() for channel in channels), strict=True)


def sideslip(p: Any, car: Any, period: float, given: Given) -> np.ndarray:
    """Sideslip angle [rad] by the observer at the measured speed; in reverse that of the rear."""
    s = SlipAngleObserverState()
    lateral = []
    for speed, across, yaw_rate, angle in _instants(given, _SPEED, _ACROSS, _YAW_RATE, _ANGLE):
        turn = Turn(speed, across, yaw_rate, angle)
        slip_angles_at(p, car, s, period, turn, p.kinematic_share)
        lateral.append(s.lateral_velocity)
    # Both turned by the direction of travel, else a car that rolls straight back would have an
    # angle of pi.
    ahead = np.where(given[_SPEED] < 0.0, -1.0, 1.0)
    estimated: np.ndarray = np.arctan2(ahead * np.array(lateral), ahead * given[_SPEED])
    return estimated


def speed(p: Any, car: Any, period: float, given: Given) -> np.ndarray:
    """Speed of the car [m/s] that slip is counted against."""
    s = ReferenceSpeedState()
    # A record without the driver's torque: nothing is asked, so all wheels count as rolling.
    direction = np.sign(given.get(_DRIVE, np.zeros(len(given[_ANGLE])))).tolist()
    found = []
    signals = _instants(given, *_WHEELS, _ALONG, _ACROSS, _YAW_RATE, _ANGLE)
    for sign, (one, two, three, four, along, across, yaw_rate, angle) in zip(
        direction, signals, strict=True
    ):
        sensors = Sensors(
            # The estimate reads no more of the sensors than the record has.
            SteeringColumnState(0.0, 0.0, 0.0, angle, 0.0),
            WheelStates(NO_WHEELS, Wheels(one, two, three, four), NO_WHEELS),
            InertialMeasurement(yaw_rate, along, across),
        )
        rolling_speeds(p, car, s, period, sensors, sign)
        found.append(s.speed)
    return np.array(found)


ESTIMATORS = {
    "slip_angle_observer": Estimator(
        SlipAngleObserverParameters, (_SPEED, _ACROSS, _YAW_RATE, _ANGLE), (), "sideslip", sideslip
    ),
    "reference_speed": Estimator(
        ReferenceSpeedParameters,
        (*_WHEELS, _ALONG, _ACROSS, _YAW_RATE, _ANGLE),
        (_DRIVE,),
        _SPEED,
        speed,
    ),
}
