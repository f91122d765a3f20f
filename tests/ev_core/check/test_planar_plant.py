"""The planar plant keeps the contract on all cars and roads."""

from __future__ import annotations

import pytest

from ev_core.check.method import check_configuration
from ev_core.lockstep.configuration import configure
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_stack.scenarios.files import vehicle_file

pytestmark = pytest.mark.slow

PERIODS = 15  # plain Python takes about 10 ms for a step of 1 ms
ALL_DRIVEN = {"vehicle.driven_wheels": list(WHEEL_NAMES)}
REAR_DRIVEN = {"vehicle.driven_wheels": ["rear_left", "rear_right"]}
MAGIC = {"vehicle.tyre.curve": "magic_formula", "vehicle.tyre.coefficients": [10.0, 1.6, 0.9, 0.5]}
TWO_EXPONENTIAL = {
    "vehicle.tyre.curve": "two_exponential",
    "vehicle.tyre.coefficients": [0.35, 0.05, 0.15, 0.0],
}
RATIONAL = {"vehicle.tyre.curve": "rational", "vehicle.tyre.coefficients": [0.8, 0.2, 0.0, 0.0]}
LINEAR = {"vehicle.tyre.curve": "linear", "vehicle.tyre.coefficients": [20.0, 0.0, 0.0, 0.0]}
UNCOUPLED = {"vehicle.tyre.combined": "uncoupled"}
MAP = {
    "vehicle.motor.map_speed": [50.0, 100.0, 400.0],
    "vehicle.motor.map_torque": [10.0, 100.0],
    "vehicle.motor.map_efficiency": [0.5, 0.6, 0.8, 0.7, 0.85, 0.95],
}
SPLIT = {"road.left": ["packed_snow_1"], "road.right": ["dry_asphalt"]}
SHORT_SEGMENTS = {"road.pattern": "random", "road.random_shortest": 0.1, "road.random_longest": 0.5}
SLOPES = {
    "road.slope_distance": [0.0, 1.0],
    "road.grade": [0.0, 0.2],
    "road.side_slope": [0.0, 0.05],
}
SMALL_BATTERY = {"vehicle.battery.discharge_power": 5e3, "vehicle.battery.charge_power": 1e3}
CHOICES = {
    "as it comes": {},
    "four motors on split friction": {**ALL_DRIVEN, **SPLIT, "initial_speed": 15.0},
    "clutches": {**ALL_DRIVEN, **TWO_EXPONENTIAL, "vehicle.driveline.coupling": "clutch"},
    "limited slip": {
        **REAR_DRIVEN,
        **MAGIC,
        "vehicle.driveline.coupling": "limited_slip",
        "initial_speed": 5.0,
    },
    "open differential": {
        **RATIONAL,
        "vehicle.driveline.coupling": "open",
        "vehicle.steering_geometry": "parallel",
    },
    "blended brakes": {**UNCOUPLED, "vehicle.blend_brakes": True, "initial_speed": 10.0},
    "linear tyres": {
        **LINEAR,
        **UNCOUPLED,
        "vehicle.tyre.lateral_curve": "linear",
        "initial_speed": 20.0,
    },
    "tyres estimated by TMeasy": {
        **ALL_DRIVEN,
        **SPLIT,
        "vehicle.tyre.curve": "tmeasy",
        "vehicle.tyre.combined": "normalized",
        "vehicle.tyre.estimated_from": "175/60R15 81",
        "initial_speed": 15.0,
    },
    "efficiency map": {**MAP, "initial_speed": 8.0, "vehicle.motor.rotor_inertia": 0.05},
    "small battery": {**SMALL_BATTERY, "initial_speed": 20.0, "vehicle.motor.gear_efficiency": 0.9},
    "random road": {**SHORT_SEGMENTS, "initial_speed": 25.0},
    "slopes": {**SLOPES, "initial_speed": -10.0, "step": 7e-4},
    "held speed": {"speed": "held", "initial_speed": 12.0},
    "imposed speed": {
        "speed": "imposed",
        "imposed_speed.time": [0.0, 0.1],
        "imposed_speed.speed": [0.0, 1.0],
    },
    "an axle with a differential and one without": vehicle_file("layout_1_8_b").values_for(
        "/ev/plant"
    ),
    "centre differential with DCCD": {
        **vehicle_file("centre_dccd").values_for("/ev/plant"),
        **SPLIT,
    },
    "engine": {**vehicle_file("engine_4x4").values_for("/ev/plant"), "initial_speed": 10.0},
    "ideal drives": {"drive": "ideal", "initial_speed": 5.0},
    "averaged drives": {"drive": "averaged", "initial_speed": 5.0},
    "rear steering": {"rear_steering": True, "initial_speed": 10.0},
    "speed mode": {"speed_mode": True, "initial_speed": 10.0},
    "all options": {
        **ALL_DRIVEN,
        "electrical": True,
        "rear_steering": True,
        "speed_mode": True,
        "initial_speed": 10.0,
    },
    "electrical side": {"electrical": True, "initial_speed": 10.0},
}


@pytest.mark.parametrize("choice", CHOICES)
@pytest.mark.sampled
def test_choices(choice):
    """Every choice keeps the contract; a road drawn at random for each side has no mirror image."""
    configuration = configure("plant", {"method": "planar", **CHOICES[choice]})
    check_configuration(configuration, steps=PERIODS, seeds=[1], mirrored=choice != "random road")


@pytest.mark.parametrize(
    "choice",
    [
        "four motors on split friction",
        pytest.param("all options", marks=pytest.mark.weekly),  # one more plant to compile
    ],
)
def test_the_semi_implicit_integrator(choice):
    """It keeps the contract as the reference does."""
    values = {"method": "planar", **CHOICES[choice], "integrator": "semi_implicit"}
    check_configuration(configure("plant", values), steps=PERIODS, seeds=[1], mirrored=True)


def test_switched_drives():
    """They take many small steps, so fewer periods."""
    configuration = configure(
        "plant", {"method": "planar", "drive": "switched", "initial_speed": 3.0}
    )
    check_configuration(configuration, steps=3, seeds=[1])
