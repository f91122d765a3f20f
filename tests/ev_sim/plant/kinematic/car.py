"""A car with the kinematic plant, which runs compiled, and commands for it."""

import math
from dataclasses import replace

from helpers.compiled_object import CompiledObject

from ev_core.lockstep.finding import find_method
from ev_core.parameters.values import build
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.signals import BodyVelocity, SteeringColumnState, WheelTorqueCommand
from ev_msgs_py.contract.wheels import NO_WHEELS, Wheels

KINEMATIC = find_method("plant", "kinematic")
PERIOD = 0.01
AUDI = Vehicle()
WITHOUT_DRAG = replace(AUDI, drag_coefficient=0.0)
WITHOUT_RESISTANCE = replace(WITHOUT_DRAG, rolling_resistance=0.0)
# rolling resistance as a torque at the wheels [N m], eq 13
ROLLING_TORQUE = 0.015 * 1400.0 * 9.81 * 0.294
COAST = WheelTorqueCommand(NO_WHEELS)


class Car:
    """A plant with its outputs by signal type."""

    def __init__(self, vehicle=AUDI, **parameters):
        self.plant = CompiledObject(
            KINEMATIC, build(KINEMATIC.parameters, parameters), vehicle, PERIOD
        )

    def drive(self, command=COAST, *, degrees=0.0, steps=1):
        column = SteeringColumnState(0.0, 0.0, 0.0, math.radians(degrees), 0.0)
        for _ in range(steps):
            self.plant.advance(command, column)
        return self

    def __getitem__(self, signal):
        return dict(zip(KINEMATIC.writes, self.plant.outputs(), strict=True))[signal]

    @property
    def speed(self):
        velocity = self[BodyVelocity]
        return math.copysign(
            math.hypot(velocity.longitudinal, velocity.lateral), velocity.longitudinal
        )


def torque(total):
    """A drive torque shared by the front wheels."""
    return WheelTorqueCommand(Wheels.front(total / 2, total / 2))


def brake(total):
    return WheelTorqueCommand(NO_WHEELS, Wheels.all(total / 4))
