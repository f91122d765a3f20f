"""The law of Zhileykin (2018) asked for its shares at a single instant, without a run."""

from __future__ import annotations

import math
from typing import NamedTuple

from ev_msgs_py.contract.signals import (
    BodyVelocity,
    DriverCommand,
    InertialMeasurement,
    SteeringColumnState,
    WheelStates,
)
from ev_msgs_py.contract.wheels import NO_WHEELS, Wheels
from ev_msgs_py.lockstep.methods import create, find_method
from ev_msgs_py.parameters.declaration import flatten
from ev_msgs_py.parameters.values import build
from ev_sim.verdicts.need import ScenarioRuns

FORCE = 3000.0  # X, that the driver asks for [N]
_ROLE = "electronic_differential"
_SPEED = 8.0  # [m/s]


class Shares(NamedTuple):
    """Of the front axle in the torque of the car, and of the rear wheels in that of their axle [1]."""

    front: float
    slower: float
    faster: float


def shares(
    driven: ScenarioRuns, acceleration: float, phi: float = 0.0, road_wheel_angle: float = 0.0, **readings: object
) -> Shares:
    """What the law asks for at an acceleration [m/s^2] at an angle phi to the car's axis [rad] and a road-wheel angle.

    Car and parameters are those that were driven, but for the `readings`. The left rear wheel is the slower one, and
    the car has no slip angle that would choose a branch.
    """
    method, vehicle = find_method(_ROLE, "axle_redistribution"), driven.vehicle
    known = flatten(method.parameters())
    told = {name: value for name, value in driven.parameters.get(_ROLE, {}).items() if name in known}
    law = create(method, build(method.parameters, {**told, **readings}), vehicle, 0.01)
    signals = {
        type(signal): signal
        for signal in (
            DriverCommand(FORCE * vehicle.wheel_radius, 0.0, 0.0),
            SteeringColumnState(0.0, 0.0, 0.0, road_wheel_angle, 0.0),
            WheelStates(NO_WHEELS, Wheels(20.0, 20.0, 20.0, 21.0), NO_WHEELS),
            InertialMeasurement(0.0, acceleration * math.cos(phi), acceleration * math.sin(phi)),
            BodyVelocity(_SPEED, _SPEED * math.tan(road_wheel_angle / 2), 0.0),
        )
    }
    drive = law.step(*(signals[kind] for kind in method.reads)).drive
    front, rear = drive.front_left + drive.front_right, drive.rear_left + drive.rear_right
    return Shares(front / (front + rear), drive.rear_left / rear, drive.rear_right / rear)
