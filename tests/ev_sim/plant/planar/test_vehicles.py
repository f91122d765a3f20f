"""Every vehicle and every road of config/ drives."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest
import yaml
from helpers.compiled_object import CompiledObject
from plant.planar.car import PLANAR, STRAIGHT, outputs, plant, steered

from ev_core.parameters.values import build
from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.files import with_files
from ev_msgs_py.contract.signals import TireForces, WheelTorqueCommand
from ev_msgs_py.contract.wheels import WHEEL_NAMES, Wheels
from ev_sim.plant.planar.planar import PlanarPlantParameters
from ev_sim.plant.planar.planar_state import index

CONFIG = Path(__file__).parents[4] / "config"
VEHICLES = sorted((CONFIG / "vehicles").glob("*.yaml"))
ROADS = sorted((CONFIG / "surfaces").glob("*.yaml"))


def flat(tree: dict, prefix: str = "") -> dict:
    values = {}
    for name, value in tree.items():
        if isinstance(value, dict):
            values |= flat(value, f"{prefix}{name}.")
        else:
            values[prefix + name] = tuple(value) if isinstance(value, list) else value
    return values


def vehicle(path: Path) -> Vehicle:
    return with_files(
        build(Vehicle, flat(yaml.safe_load(path.read_text())["/**"]["ros__parameters"]["vehicle"]))
    )


@pytest.mark.parametrize("path", VEHICLES, ids=lambda path: path.stem)
def test_vehicle_drives(path):
    """Every vehicle pulls away with 0.5 m/s^2 to spare, turns, and comes to rest again."""
    car = vehicle(path)
    assert car.name == path.stem
    driven = plant(car)
    share = 0.8 * car.mass * car.wheel_radius / len(car.driven_wheels)
    drive = Wheels(*(share if name in car.driven_wheels else 0.0 for name in WHEEL_NAMES))
    for _ in range(500):
        driven.advance(WheelTorqueCommand(drive), steered(0.02))
    assert 1.0 < driven.state[0] < 5.0
    assert driven.state[2] > 0.0
    brake = Wheels.all(0.5 * car.mass * car.wheel_radius)
    for _ in range(800):
        driven.advance(WheelTorqueCommand(Wheels.all(0.0), brake), steered(0.02))
    assert abs(driven.state[0]) < 1e-3
    assert driven.state[index("guard.non_finite")] == driven.state[index("guard.out_of_range")] == 0


def test_readings_of_the_growth_of_rolling_resistance():
    """Eq 2.8 of the dissertation, f = f_0 + k_f V^2, with 4.5e-5.

    Added in (m/s)^2, or relative to f_0 with V in km/h.

    Relative, at 47.3 km/h it adds 0.0011 to 0.0013 for k_f of 4e-5 to 5e-5, added 0.0069 to 0.0086.
    """
    car = vehicle(CONFIG / "vehicles" / "dissertation_class_b.yaml")
    assert (car.rolling_resistance_speed, car.rolling_resistance_reading) == (4.5e-5, "relative")
    assert car.rolling_resistance_growth == pytest.approx(7.0e-6, rel=1e-3)
    fast = 47.3 / 3.6
    assert 0.0010 < car.rolling_resistance_growth * fast**2 < 0.0013
    literal = dataclasses.replace(car, rolling_resistance_reading="added")
    assert literal.rolling_resistance_growth == 4.5e-5
    assert 0.0069 < literal.rolling_resistance_growth * fast**2 < 0.0086


@pytest.mark.parametrize("path", ROADS, ids=lambda path: path.stem)
def test_road_drives(path):
    road = flat(yaml.safe_load(path.read_text())["/**/plant"]["ros__parameters"])
    car = CompiledObject(
        PLANAR, build(PlanarPlantParameters, {**road, "initial_speed": 15.0}), Vehicle(), 0.01
    )
    friction = []
    for _ in range(500):
        car.advance(WheelTorqueCommand(Wheels.front(80.0, 80.0)), STRAIGHT)
        friction.append(outputs(car)[TireForces].friction_coefficient)
    assert np.isfinite(car.state).all()
    values = np.unique(np.round(friction, 6))
    if path.stem in ("jump_dry_ice_dry", "checkerboard", "dissertation_mixed"):
        assert len(values) == 2
