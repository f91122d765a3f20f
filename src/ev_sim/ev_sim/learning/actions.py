"""What a learner may do: whose place it takes, and how its numbers become what that role writes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.signals import DriverCommand, WheelTorqueCommand, WheelTorqueRequest
from ev_msgs_py.contract.topics import TOPICS

Frame = Mapping[str, float]

LARGEST_HAND_TORQUE = 20.0  # [N m], what two hands do in an emergency; drivers of the scenarios stay below


@dataclass(frozen=True)
class Action:
    """A kind of action, in the place of a `role`; of what that role writes it says some `channels`.

    `bounds` gives lowest and highest values, (number of channels,) each, and `means` what is written for an action at
    an instant. `of_law` is the action that stands for what the law wrote.
    """

    role: str
    channels: Callable[[Vehicle], tuple[str, ...]]
    bounds: Callable[[Vehicle], tuple[np.ndarray, np.ndarray]]
    means: Callable[[Frame, tuple[str, ...], np.ndarray], dict[str, float]]
    of_law: Callable[[np.ndarray], np.ndarray]


def _drive(signal: type) -> Callable[[Vehicle], tuple[str, ...]]:
    prefix = TOPICS[signal].name
    return lambda vehicle: tuple(f"{prefix}.drive.{wheel}" for wheel in vehicle.driven_wheels)


def _wheel_torques(vehicle: Vehicle) -> tuple[np.ndarray, np.ndarray]:
    """What the motors can do at the wheels [N m]."""
    ones = np.ones(len(vehicle.driven_wheels))
    lowest, highest = -vehicle.motor.generator_torque, vehicle.motor.peak_torque
    return lowest * vehicle.gear_ratio * ones, highest * vehicle.gear_ratio * ones


def _torque_limits(vehicle: Vehicle) -> tuple[np.ndarray, np.ndarray]:
    lowest, highest = _wheel_torques(vehicle)
    return np.zeros_like(highest), np.maximum(-lowest, highest)


def _hand_torque(vehicle: Vehicle) -> tuple[np.ndarray, np.ndarray]:
    return np.array([-LARGEST_HAND_TORQUE]), np.array([LARGEST_HAND_TORQUE])


def _as_it_is(here: Frame, channels: tuple[str, ...], action: np.ndarray) -> dict[str, float]:
    return dict(zip(channels, action.tolist(), strict=True))


def _limited(here: Frame, channels: tuple[str, ...], action: np.ndarray) -> dict[str, float]:
    """The torques that are asked for at this instant, none larger than its limit, either way."""
    command, request = TOPICS[WheelTorqueCommand].name, TOPICS[WheelTorqueRequest].name
    asked = [here[request + channel.removeprefix(command)] for channel in channels]
    limited = [max(min(torque, limit), -limit) for torque, limit in zip(asked, action.tolist(), strict=True)]
    return dict(zip(channels, limited, strict=True))


ACTIONS = {
    # drive torque of each driven wheel [N m]; the brakes stay with the law
    "torque_split": Action(
        "electronic_differential", _drive(WheelTorqueRequest), _wheel_torques, _as_it_is, np.asarray
    ),
    # largest drive torque of each driven wheel, either way [N m]
    "traction_control": Action("asr", _drive(WheelTorqueCommand), _torque_limits, _limited, np.abs),
    # torque of the hands on the steering wheel [N m]; the pedals stay with the driver
    "steering": Action(
        "driver", lambda _: (f"{TOPICS[DriverCommand].name.replace('/', '.')}.hand_torque",), _hand_torque, _as_it_is,
        np.asarray,
    ),
}  # fmt: skip
