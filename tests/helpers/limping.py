"""A limp mode on two motors of an axle, as simple as they can be.

Limits that both share, their own faults, a lag.
"""

from __future__ import annotations

import dataclasses
import math
import random
from collections.abc import Callable
from typing import Any

from ev_core.lockstep.finding import find_method
from ev_core.methods.method_record import create
from ev_core.parameters.record import names
from ev_core.parameters.values import build
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.signals import WheelStates, WheelTorqueRequest
from ev_msgs_py.contract.wheels import NO_WHEELS, Wheels

PERIOD = 0.01
# the Audi A2: 150 N m for ever, behind a gear of 2.65
CAR = Vehicle(driven_wheels=("front_left", "front_right"))

Fault = Callable[[float], float]  # what a motor gives [N m] instead of what it would


def dead(_torque: float) -> float:
    return 0.0


def dragging(_torque: float) -> float:
    """Switched off, and its rotor takes a little."""
    return -1.0


def at_half(torque: float) -> float:
    return 0.5 * torque


def stuck_at(stuck: float) -> Fault:
    return lambda _torque: stuck


@dataclasses.dataclass
class Motors:
    """Front motors: the command up to `most` [N m], times `battery`, at the wheel and common."""

    car: Vehicle = CAR
    period: float = PERIOD
    most: float = math.inf
    battery: float = 1.0
    faults: tuple[Fault | None, Fault | None] = (None, None)
    noise: float = 0.0  # standard deviation of the sensor [N m]
    seed: int = 0

    def __post_init__(self) -> None:
        self._torque = [0.0, 0.0]
        self._random = random.Random(self.seed)

    def measured(self, commanded: Wheels, speed: Wheels) -> Wheels:
        """Torques at the wheels as the sensors show them, means over a period."""
        motor, gear = self.car.motor, self.car.gear_ratio
        passed = self.period / motor.torque_lag
        left, mean = math.exp(-passed), 1.0 + math.expm1(-passed) / passed
        shown = []
        for i in range(2):
            turns = abs(speed[i])
            most = min(self.most, motor.peak_torque * gear, motor.peak_power / max(turns, 1e-9))
            goal = self.battery * min(max(commanded[i], -most), most)
            fault = self.faults[i]
            if fault is not None:
                goal = fault(goal)
            gap = goal - self._torque[i]
            torque = self._torque[i] + mean * gap
            self._torque[i] = goal - left * gap
            efficiency = motor.gear_efficiency
            at_wheel = torque * efficiency if torque * speed[i] >= 0.0 else torque / efficiency
            shown.append(at_wheel + (self._random.gauss(0.0, self.noise) if self.noise else 0.0))
        return Wheels.front(*shown)


class Limping:
    """The law `limp_home`, interpreted, with motors."""

    def __init__(self, motors: Motors | None = None, **changed: Any) -> None:
        self.motors = motors or Motors()
        method = find_method("asr", "limp_home")
        given = {f"plausibility.{name}": value for name, value in changed.items()}
        self.law = create(
            method, build(method.parameters, given), self.motors.car, self.motors.period
        )
        self._names = names(method.law.state())
        self.measured = NO_WHEELS

    def step(self, asked: Wheels, speed: Wheels, brake: Wheels = NO_WHEELS) -> Wheels:
        """Return the commands to the drives [N m].

        The next step measures what the drives make of them.
        """
        command = self.law.step(
            WheelTorqueRequest(asked, brake), WheelStates(NO_WHEELS, speed, self.measured)
        )
        assert command.brake == brake
        self.measured = self.motors.measured(command.drive, speed)
        return command.drive

    def drive(self, left: float, right: float, seconds: float, speed: float = 50.0) -> Wheels:
        """The last command [N m] after so long with these requests, at a wheel speed [rad/s]."""
        command = NO_WHEELS
        for _ in range(round(seconds / self.motors.period)):
            command = self.step(Wheels.front(left, right), Wheels.all(speed))
        return command

    def lost(self) -> list[int]:
        """Front motors that count as lost, left and right: 0 or 1."""
        state = dict(zip(self._names, self.law.state, strict=True))
        return [int(state[f"motors.lost.{wheel}"]) for wheel in ("front_left", "front_right")]
