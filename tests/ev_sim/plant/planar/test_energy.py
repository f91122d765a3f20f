"""Energy: it never grows by itself, and all of it is accounted for."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from plant.planar.car import (
    CAR,
    ESTIMATED,
    by_each_way,
    command,
    elastic_energy,
    kinetic_energy,
    plant,
    steered,
)
from plant.planar.manoeuvres import MANOEUVRES

from ev_core.vehicle.tyre import Tyre
from ev_sim.plant.planar.given import INTEGRATORS
from ev_sim.plant.planar.planar_state import VX, VY, WHEEL_SPEED, YAW_RATE, index

TYRES = (Tyre(combined="slip_vector"), Tyre(combined="uncoupled"), ESTIMATED)


def test_energy_never_grows():
    """Kinetic and carcass energy only fall from 64 random states without torque, by each integrator.

    The carcasses start unloaded, so the kinetic energy never comes back above its start.
    """
    free = dataclasses.replace(CAR, drag_coefficient=0.0, rolling_resistance=0.0)
    generator = np.random.default_rng(3)
    surfaces = ("dry_asphalt", "wet_asphalt_1", "packed_snow_2", "ice")
    for n in range(64):
        tyre = TYRES[n % 3]
        road = {"road__left": (surfaces[n % 4],), "road__right": (surfaces[n // 4 % 4],)}
        integrator = INTEGRATORS[n // 16 % 2]
        found = dataclasses.replace(free, tyre=tyre)
        car = plant(found, period=1e-3, integrator=integrator, **road)
        car.state[[VX, VY, YAW_RATE]] = generator.uniform((-30, -10, -3), (30, 10, 3))
        car.state[WHEEL_SPEED : WHEEL_SPEED + 4] = generator.uniform(-100, 100, 4)
        angle = steered(generator.uniform(-0.5, 0.5))
        start = energy = kinetic_energy(car.state)
        for _ in range(400):
            car.advance(command(), angle)
            now = kinetic_energy(car.state) + elastic_energy(car.state)
            assert now <= energy
            energy = now
        assert kinetic_energy(car.state) <= start


@by_each_way
@pytest.mark.parametrize("name", MANOEUVRES)
def test_power_balance_closes(name, way):
    """Battery = losses + drive.

    drive = change of kinetic energy + tyres + friction + air + slope + hold: 1e-6, and to rounding
    where works are forces times mean velocities of a step.
    """
    parameters, inputs = MANOEUVRES[name]
    car = plant(road__grade=(0.03,), **parameters, **way)
    work = {n: index(n) for n in ("battery_work", "motor_loss", "driveline_loss", "auxiliary_work", "drive_work",
                                  "tyre_work", "friction_work", "drag_work", "gravity_work",
                                  "holding_work")}  # fmt: skip
    start, elastic = kinetic_energy(car.state), elastic_energy(car.state)
    for n in range(400):
        car.advance(*inputs(n * 0.01))
    got = {n: float(car.state[place]) for n, place in work.items()}
    turnover = sum(abs(value) for value in got.values()) + start
    electrical = (
        got["motor_loss"] + got["driveline_loss"] + got["auxiliary_work"] + got["drive_work"]
    )
    assert abs(got["battery_work"] - electrical) < 1e-9 * turnover
    used = (
        got["tyre_work"]
        + got["friction_work"]
        + got["drag_work"]
        + got["gravity_work"]
        + got["holding_work"]
    )
    change = kinetic_energy(car.state) - start
    allowed = 1e-12 if way else 1e-6
    assert abs(got["drive_work"] - used - change) < allowed * turnover
    assert got["tyre_work"] - (elastic_energy(car.state) - elastic) > 0.0
    assert got["friction_work"] > 0.0
