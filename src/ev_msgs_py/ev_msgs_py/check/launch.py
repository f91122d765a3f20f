"""A launch as a law sees it: the pedal goes down, wheels spin up and grip again, forwards or in reverse."""

from __future__ import annotations

import math
import random
from collections.abc import Mapping
from typing import Any

from ev_msgs_py.contract.signals import (
    BodyVelocity,
    DriverCommand,
    InertialMeasurement,
    SteeringColumnState,
    WheelStates,
    WheelTorqueCommand,
    WheelTorqueRequest,
)
from ev_msgs_py.contract.wheels import NO_WHEELS, Wheels

_RADIUS = 0.32  # of the wheels [m]
_PRESSED = 0.15  # probability that the brake is pressed all the time
_RARE = 0.003  # probability in a step that the pedal is let go, or that a measurement is none
_TURNING = 0.02  # probability in a step that a wheel begins to grip or to spin
_BRAKE = 200.0  # N m
_RATE = 0.01  # share of the drive torque by which the pedal goes down in a step


class Launch:
    """Signals of one launch of `steps` steps; wheels slip at random rates, and what they give is that of a tyre."""

    def __init__(self, chance: random.Random, period: float) -> None:
        r = self._random = chance
        self._period = period
        self.steps = r.randint(40, 160)
        self._ahead = r.choice((1.0, 1.0, -1.0))
        self._asked = [self._ahead * r.uniform(200.0, 1800.0) for _ in range(4)]
        self._pedal = 0.0
        self._brake = Wheels.all(_BRAKE) if r.random() < _PRESSED else NO_WHEELS
        self._speed = r.choice((0.0, 0.0, r.uniform(0.0, 15.0)))  # of the car [m/s]
        self._pull = r.uniform(0.2, 4.0)  # [m/s^2]
        self._slip = [0.0] * 4
        spins = r.choice(((1.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 1.0), (1.0, 1.0, 1.0, 1.0)))
        self._growth = [spin * r.uniform(0.1, 1.5) for spin in spins]  # [1/s]
        self._angle, self._yaw_rate = r.choice((0.0, r.uniform(-0.4, 0.4))), r.choice((0.0, r.uniform(-0.6, 0.6)))

    def next(self) -> Mapping[type, Any]:
        """By type the signals of the next step, as far as a launch is what makes them."""
        r = self._random
        self._speed += self._pull * self._period
        if r.random() < _TURNING:
            self._growth[r.randrange(4)] *= -1.0
        grown = zip(self._slip, self._growth, strict=True)
        self._slip = [min(max(slip + growth * self._period, 0.0), 0.9) for slip, growth in grown]
        rolling = self._ahead * self._speed / _RADIUS
        speed = Wheels(*(rolling / (1.0 - slip) + r.gauss(0.0, 0.03) for slip in self._slip))
        share = [math.sqrt(slip / 0.1 + 0.01) / (1.0 + slip / 0.1) for slip in self._slip]
        torque = Wheels(*(asked * each for asked, each in zip(self._asked, share, strict=True)))
        self._pedal = 0.0 if r.random() < _RARE else min(self._pedal + _RATE, 1.0)
        if r.random() < _RARE:
            speed = Wheels.all(1e5)  # no measurement of a road vehicle
        drive = Wheels(*(self._pedal * asked for asked in self._asked))
        said = (
            DriverCommand(sum(drive), sum(self._brake), 0.0),
            WheelTorqueRequest(drive, self._brake),
            WheelTorqueCommand(drive, self._brake),
            SteeringColumnState(0.0, 0.0, 0.0, self._angle, 0.0),
            WheelStates(NO_WHEELS, speed, torque),
            InertialMeasurement(self._yaw_rate, self._ahead * self._pull + r.gauss(0.0, 0.05), r.gauss(0.0, 1.0)),
            BodyVelocity(self._ahead * self._speed, 0.0, self._yaw_rate),
        )
        return {type(signal): signal for signal in said}
