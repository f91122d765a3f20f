"""Steering column and law in a loop of their own, without plant: the torques act at once."""

from __future__ import annotations

import dataclasses

import numpy as np
from helpers.differentials import SHCHUR, Differential

from ev_core.lockstep.finding import find_method
from ev_core.methods.method_record import create
from ev_core.parameters.record import names
from ev_msgs_py.contract.signals import (
    DriverCommand,
    SteeringColumnState,
    WheelStates,
    WheelTorqueRequest,
)
from ev_msgs_py.contract.wheels import NO_WHEELS, Wheels

PERIOD = 0.001
LEVER = 1.462 / (2 * 0.294)  # d/(2 r_k)
J, B, K = 2.8, 7.5, 65.0  # inertia, damping and stiffness of the steering system (Shchur 2019)
RATIO = 16.0
AT_REST = WheelStates(NO_WHEELS, NO_WHEELS, NO_WHEELS)


def law(name: str, **changed) -> Differential:
    return Differential(name, SHCHUR, PERIOD, **changed)


def difference(request: WheelTorqueRequest) -> float:
    return request.drive.front_right - request.drive.front_left


class Column:
    """A steering column; with `held`, its steering wheel stays at an angle [rad]."""

    def __init__(self, name: str, held: float | None = None, **changed: float) -> None:
        method = find_method("steering_column", name)
        self._names = names(method.law.state())
        self._object = create(
            method, dataclasses.replace(method.parameters(), **changed), SHCHUR, PERIOD
        )
        if held is not None:
            self.hold(held)
        self._held = held

    def hold(self, angle: float) -> None:
        self._held = angle
        self.put(angle=angle, rate=0.0)

    def put(self, **values: float) -> None:
        """Change numbers of the state."""
        row = list(self._object.state)
        for name, value in values.items():
            row[self._names.index(name)] = value
        self._object.state = row

    def shown(self) -> SteeringColumnState:
        (state,) = self._object.outputs()
        return state

    def advance(self, driver: DriverCommand, wheels: WheelStates) -> None:
        self._object.advance(driver, wheels)
        if self._held is not None:
            self.hold(self._held)


def drive(
    column: Column,
    differential: Differential,
    hand_torque: float,
    duration: float,
    disturbance: float = 0.0,
):
    """Road-wheel angles [rad] and torque differences [N m] over time.

    `disturbance` is a torque difference [N m] that the law does not know of.
    """
    angles, differences = [], []
    driver = DriverCommand(0.0, 0.0, hand_torque)
    for _ in range(round(duration / PERIOD) + 1):
        state = column.shown()
        request = differential.object.step(driver, state, AT_REST)
        angles.append(state.road_wheel_angle)
        differences.append(difference(request))
        left, right = request.drive.front_left, request.drive.front_right
        column.advance(
            driver, WheelStates(NO_WHEELS, NO_WHEELS, Wheels.front(left, right + disturbance))
        )
    return np.array(angles), np.array(differences)
