"""A car with the planar plant, which runs compiled, and commands for it."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from helpers.compiled_object import CompiledObject

from ev_core.lockstep.finding import find_method
from ev_core.parameters.values import build
from ev_core.vehicle.battery import Battery
from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.motor import Motor
from ev_core.vehicle.tyre import Tyre
from ev_msgs_py.contract.signals import SteeringColumnState, WheelTorqueCommand
from ev_msgs_py.contract.wheels import WHEEL_NAMES, Wheels
from ev_sim.plant.planar.given import body_constants
from ev_sim.plant.planar.planar import PlanarPlantParameters
from ev_sim.plant.planar.planar_state import (
    DEFLECTION_X,
    DEFLECTION_Y,
    VX,
    VY,
    WHEEL_SPEED,
    YAW_RATE,
    index,
)

PLANAR = find_method("plant", "planar")
STRONG = Motor(
    peak_torque=2000.0,
    nominal_torque=2000.0,
    peak_power=1e6,
    generator_torque=2000.0,
    generator_power=1e6,
)
FULL_BATTERY = Battery(discharge_power=1e6, charge_power=1e6, resistance=0.01)
CAR = Vehicle(motor=STRONG, battery=FULL_BATTERY)
FOUR_MOTORS = dataclasses.replace(CAR, driven_wheels=WHEEL_NAMES)
# Tyres of the size of this car's wheels, of curve tmeasy.
ESTIMATED = Tyre(curve="tmeasy", combined="normalized", estimated_from="175/60R15 81")
X, Y = index("x"), index("y")
# Parameters of the plant for each integrator, and for the longest step of the second.
WAYS = {
    "runge_kutta": {},
    "semi_implicit": {"integrator": "semi_implicit"},
    "semi_implicit at 5 ms": {"integrator": "semi_implicit", "step": 5e-3},
}
by_each_way = pytest.mark.parametrize("way", WAYS.values(), ids=WAYS)


def parameters_of(**values) -> PlanarPlantParameters:
    """A double underscore stands for the dot."""
    return build(
        PlanarPlantParameters, {name.replace("__", "."): value for name, value in values.items()}
    )


def plant(car: Vehicle = CAR, period: float = 0.01, **parameters) -> CompiledObject:
    found = parameters_of(**parameters)
    return CompiledObject(PLANAR.with_options(found, car), found, car, period)


def outputs(car: CompiledObject) -> dict[type, tuple]:
    return {type(signal): signal for signal in car.outputs()}


def on(surface: str) -> dict:
    return {"road__left": (surface,), "road__right": (surface,)}


def command(drive=(0.0, 0.0, 0.0, 0.0), brake=(0.0, 0.0, 0.0, 0.0)) -> WheelTorqueCommand:
    return WheelTorqueCommand(Wheels(*drive), Wheels(*brake))


def steered(angle: float, rate: float = 0.0) -> SteeringColumnState:
    return SteeringColumnState(0.0, 0.0, 0.0, angle, rate)


STRAIGHT = steered(0.0)


def kinetic_energy(state: np.ndarray, car: Vehicle = CAR) -> float:
    """Kinetic energy of body and wheels with their rotors [J]."""
    wheels = float(
        np.sum(
            np.array(body_constants(car).wheel_inertia) * state[WHEEL_SPEED : WHEEL_SPEED + 4] ** 2
        )
    )
    body = car.mass * (state[VX] ** 2 + state[VY] ** 2) + car.yaw_inertia * state[YAW_RATE] ** 2
    return 0.5 * float(wheels + body)


def elastic_energy(state: np.ndarray, car: Vehicle = CAR) -> float:
    """Elastic energy of the carcasses [J]."""
    along, across = state[DEFLECTION_X : DEFLECTION_X + 4], state[DEFLECTION_Y : DEFLECTION_Y + 4]
    tyre = car.tyre
    return 0.5 * float(
        tyre.longitudinal_stiffness * np.sum(along**2) + tyre.lateral_stiffness * np.sum(across**2)
    )


def drive(
    car: CompiledObject, seconds: float, torques: Wheels, brake: float = 0.0
) -> dict[type, tuple]:
    """The outputs after some time straight ahead."""
    for _ in range(round(seconds / 0.01)):
        car.advance(WheelTorqueCommand(torques, Wheels.all(brake)), STRAIGHT)
    return outputs(car)
