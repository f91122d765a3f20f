"""Every steering column keeps the contract, at any parameters and as in the scenarios."""

from __future__ import annotations

import pytest
from helpers.scenario_roles import configurations_in

from ev_core.check.method import check_configuration
from ev_core.lockstep.configuration import configure
from ev_stack.scenarios.files import scenario_names

pytestmark = pytest.mark.slow

CHOICES = {
    "sticks and meets its stops": {"method": "manual", "dry_friction": 20.0, "max_angle": 0.3},
    "overdamped": {"method": "manual", "damping": 100.0, "dry_friction": 1.0},
    "wheels with inertia": {"method": "powered", "wheel_inertia": 0.5, "dry_friction": 5.0},
    "on another car": {
        "method": "powered",
        "vehicle.steering_ratio": 12.0,
        "vehicle.front_track": 1.6,
    },
    "by wire between stops": {
        "method": "by_wire",
        "max_angle": 0.1,
        "steering_wheel.dry_friction": 0.5,
    },
    "by wire, overdamped": {"method": "by_wire", "damping": 200.0, "steering_wheel.damping": 2.0},
    "actuated, with feel": {"method": "actuated", "feel.share": 1.0, "actuator.max_angle": 0.2},
    "sine": {
        "method": "steering_robot",
        "shape": "sine_with_dwell",
        "sine_with_dwell.begin": 0.2,
        "sine_with_dwell.amplitude": 3.0,
        "max_rate": 5.0,
    },
    "front angle added": {
        "method": "active_front",
        "profile.time": [0.0, 1.0],
        "profile.angle": [0.0, 2.0],
        "gain": 2.0,
        "largest_angle": 0.1,
        "largest_rate": 1.0,
    },
    "angles in steps": {
        "method": "steering_robot",
        "profile.time": [0.0, 1.0, 2.0],
        "profile.angle": [0.5, 3.0, -1.0],
        "profile.interpolation": "step",
    },
}


@pytest.mark.parametrize("choice", CHOICES)
@pytest.mark.sampled
def test_choices(choice):
    check_configuration(configure("steering_column", CHOICES[choice]), steps=300)


@pytest.mark.parametrize("scenario", scenario_names())
@pytest.mark.sampled
def test_scenarios(scenario):
    for seed, configuration in enumerate(configurations_in(scenario, "steering_column")):
        check_configuration(configuration, steps=100, seeds=[seed])
