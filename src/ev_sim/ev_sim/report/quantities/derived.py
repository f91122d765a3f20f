"""Quantities that several reports derive from recorded channels."""

from __future__ import annotations

import math

import numpy as np

from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.vehicle.description import Vehicle
from ev_sim.report.metric import NotMeasured
from ev_sim.report.samples import channel, mean_between
from ev_sim.running.recording.recording import Recording

ROAD_WHEEL_ANGLE = "steering_column.state.road_wheel_angle"
HAND_TORQUE = "steering_column.state.hand_torque"
DRIVER_HAND_TORQUE = "driver.command.hand_torque"


def right_minus_left(recording: Recording, quantity: str) -> np.ndarray:
    """Difference of the front wheels, right minus left, (n,), in the unit of the quantity (`wheel_states.effort`)."""
    return channel(recording, f"{quantity}.front_right") - channel(recording, f"{quantity}.front_left")


def differential_torque(recording: Recording) -> np.ndarray:
    """Differential torque that the electronic differential asks for, (n,) [N m]; Shchur (2019), eq. 4."""
    return right_minus_left(recording, "torque_request.drive")


def speed(recording: Recording) -> np.ndarray:
    """Speed of the centre of mass along its path, negative backwards, (n,) [m/s]; V of Shchur (2019)."""
    longitudinal = channel(recording, "twist.longitudinal")
    return np.copysign(np.hypot(longitudinal, channel(recording, "twist.lateral")), longitudinal)


def total_drive_torque(recording: Recording) -> np.ndarray:
    """Drive torque that acts at all wheels together, (n,) [N m]."""
    return sum(channel(recording, f"wheel_states.effort.{wheel}") for wheel in WHEEL_NAMES)


def speed_difference(recording: Recording, vehicle: Vehicle) -> np.ndarray:
    """Right minus left linear speed of the front wheels, (n,) [m/s]; Shchur (2019), eq. 12."""
    return vehicle.wheel_radius * right_minus_left(recording, "wheel_states.velocity")


def hand_torque_step_time(recording: Recording) -> float:
    """Instant at which the driver lays hands on the steering wheel [s]; NotMeasured if that never happens."""
    pushing = np.flatnonzero(channel(recording, DRIVER_HAND_TORQUE))
    if not len(pushing):
        raise NotMeasured("the driver never turns the steering wheel")
    return float(recording.time[pushing[0]])


def mean_while_held(recording: Recording, values: np.ndarray, angle: float, start: float, end: float) -> float:
    """Mean over start <= time < end [s]; NotMeasured if the road-wheel angle is not held within 1 deg of `angle` [rad].

    A torque at another angle than the named one would be a different quantity.
    """
    held = mean_between(recording, channel(recording, ROAD_WHEEL_ANGLE), start, end)
    if abs(held - angle) > math.radians(1.0):
        raise NotMeasured(f"{math.degrees(held):.2f} deg are held instead of {math.degrees(angle):g} deg")
    return mean_between(recording, values, start, end)
