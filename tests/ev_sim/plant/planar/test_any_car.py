"""Random cars under random commands, and commands that no car may get."""

from __future__ import annotations

import numpy as np
import pytest
from plant.planar.car import command, outputs, plant, steered

from ev_core.vehicle.car import GRAVITY
from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.driveline import Driveline
from ev_core.vehicle.tyre import Tyre
from ev_msgs_py.contract.signals import TireForces
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_sim.plant.planar.planar_state import VX, VY, index


def test_any_car_under_any_command_stays_finite():
    """Random cars, roads, drives and steps of torque, brake and angle, all far beyond grip."""
    generator = np.random.default_rng(11)

    def between(low: float, high: float) -> float:
        return float(np.exp(generator.uniform(np.log(low), np.log(high))))

    for n in range(40):
        wheelbase = generator.uniform(0.8, 5.0)
        car = Vehicle(
            mass=between(60, 40000),
            wheelbase=wheelbase,
            centre_of_mass_to_rear_axle=generator.uniform(0.05, 0.95) * wheelbase,
            centre_of_mass_height=generator.uniform(0.0, 2.5),
            yaw_inertia=between(20, 1e5),
            wheel_radius=between(0.1, 0.8),
            wheel_inertia=between(0.05, 50),
            gear_ratio=between(0.5, 20),
            driven_wheels=WHEEL_NAMES,
            driveline=Driveline(coupling=("individual", "open", "limited_slip", "clutch")[n % 4]),
            blend_brakes=n % 3 == 0,
            tyre=Tyre(combined=("slip_vector", "uncoupled")[n % 2]),
        )
        speed, grade = generator.uniform(-20, 30) * (n % 5 > 0), generator.uniform(-0.3, 0.3)
        moving = plant(
            car,
            drive=("torque_controlled", "averaged", "ideal")[n % 3],
            initial_speed=speed,
            road__pattern="random",
            road__random_shortest=0.5,
            road__random_longest=5.0,
            road__grade=(grade,),
        )
        for k in range(200):
            if k % 20 == 0:
                drive, brake = (
                    generator.uniform(-1e4, 1e4, 4),
                    generator.choice([0, 400, 4000]) * generator.random(4),
                )
                angle = steered(*generator.uniform(-0.6, 0.6, 2))
            moving.advance(command(drive, brake), angle)
        assert np.isfinite(moving.state).all()
        assert np.abs(moving.state[[VX, VY]]).max() < 100.0
        assert sum(outputs(moving)[TireForces].load) == pytest.approx(
            car.mass * GRAVITY / np.hypot(1.0, grade)
        )


def test_bad_commands_never_reach_the_integrator():
    car = plant()
    nan, inf = float("nan"), float("inf")
    car.advance(command((nan, inf, 0.0, 0.0), (nan, -5.0, 1e9, 0.0)), steered(nan, inf))
    car.advance(command((1e9, 0.0, 0.0, 0.0)), steered(3.0))
    assert np.isfinite(car.state).all()
    assert car.state[index("guard.non_finite")] == 5
    assert car.state[index("guard.out_of_range")] == 4
