"""Drivers as objects, by parameters, and a car for them to drive."""

from __future__ import annotations

import math
from typing import Any

from ev_core.lockstep.finding import find_method
from ev_core.methods.method_record import create
from ev_core.parameters.record import names
from ev_core.parameters.values import build
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.signals import BodyVelocity, DriverCommand, Instant, SteeringColumnState

CAR = Vehicle()
PERIOD = 0.01
CENTRED = SteeringColumnState(0.0, 0.0, 0.0, 0.0, 0.0)


def driver_of(method: str, **values: Any) -> Any:
    """A driver with these parameters; a double underscore stands for the dot."""
    found = find_method("driver", method)
    named = {name.replace("__", "."): value for name, value in values.items()}
    return create(found, build(found.parameters, named), CAR, PERIOD)


def state_of(driver: Any, method: str) -> dict[str, float]:
    """The numbers that a driver keeps, by name."""
    return dict(zip(names(find_method("driver", method).law.state()), driver.state, strict=True))


def at(speed: float) -> BodyVelocity:
    """A car that goes straight on at a speed [m/s]."""
    return BodyVelocity(speed, 0.0, 0.0)


class PointMass:
    """The car as m V' = M/r - rolling - drag (Shchur 2019, eq 13) on a level road.

    Dry resistance holds it at rest.
    """

    def __init__(self, speed: float = 0.0) -> None:
        self.speed = speed

    def advance(self, command: DriverCommand) -> None:
        """One period further."""
        force = command.drive_torque / CAR.wheel_radius
        drag = (
            0.5
            * CAR.air_density
            * CAR.drag_coefficient
            * CAR.frontal_area
            * self.speed
            * abs(self.speed)
        )
        dry = command.brake_torque / CAR.wheel_radius + CAR.rolling_resistance * CAR.mass * 9.81
        if self.speed == 0.0:
            net = math.copysign(max(abs(force) - dry, 0.0), force)
        else:
            net = force - drag - math.copysign(dry, self.speed)
        speed = self.speed + net / CAR.mass * PERIOD
        self.speed = 0.0 if speed * self.speed < 0.0 else speed  # a reversal comes to rest first


def ride(driver: Any, car: PointMass, duration: float) -> list[tuple[float, float, DriverCommand]]:
    """Time, speed and command of every step of a driver that follows a speed profile."""
    rows = []
    for step in range(round(duration / PERIOD) + 1):
        command = driver.step(Instant(step * PERIOD), at(car.speed), CENTRED)
        rows.append((step * PERIOD, car.speed, command))
        car.advance(command)
    return rows
