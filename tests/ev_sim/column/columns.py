"""Steering columns, compiled, and what the tests do to them."""

from __future__ import annotations

import dataclasses
from typing import Any

from helpers.compiled_object import CompiledObject

from ev_core.lockstep.finding import find_method
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.signals import DriverCommand, SteeringColumnState, WheelStates
from ev_msgs_py.contract.wheels import NO_WHEELS, Wheels

CAR = Vehicle()
J, B, K = 2.8, 7.5, 65.0
RATIO = 16.0
LEVER = 1.462 / (2 * 0.294)  # d/(2 r_k)


def wheels_with(difference: float = 0.0, speed_difference: float = 0.0) -> WheelStates:
    """Wheels with a difference of front torques [N m] and speeds [rad/s], right minus left."""
    return WheelStates(
        NO_WHEELS,
        Wheels.front(-speed_difference / 2, speed_difference / 2),
        Wheels.front(-difference / 2, difference / 2),
    )


class Column:
    """A steering column by the name of its method, with some parameters changed."""

    def __init__(self, name: str, period: float = 0.001, **changed: Any) -> None:
        method = find_method("steering_column", name)
        self._reads = method.reads
        self._column = CompiledObject(
            method, dataclasses.replace(method.parameters(), **changed), CAR, period
        )

    def advance(
        self, hand_torque: float = 0.0, wheels: WheelStates | None = None
    ) -> SteeringColumnState:
        """The state after one more period."""
        there = {
            DriverCommand: DriverCommand(0.0, 0.0, hand_torque),
            WheelStates: wheels or wheels_with(),
        }
        self._column.advance(*(there[signal] for signal in self._reads))
        return self._column.outputs()[0]
