"""Every driver keeps the contract, whatever its parameters are, and as the scenarios have it."""

from __future__ import annotations

import dataclasses

import pytest
from helpers.scenario_roles import configurations_in

from ev_core.check.method import check_configuration
from ev_core.lockstep.configuration import Configuration, configure
from ev_stack.scenarios.files import scenario_names

pytestmark = pytest.mark.slow

# Long enough for 200 steps to see 100 s of every profile.
PERIOD = 0.5
CHOICES = {
    "step by step": {
        "method": "speed_profile",
        "speed_profile.interpolation": "step",
        "steering.mode": "hand_torque",
        "steering.hand_torque.time": [0.0, 20.0, 50.0],
        "steering.hand_torque.torque": [0.5, -3.0, 2.0],
        "steering.hand_torque.interpolation": "linear",
    },
    "angle over time": {
        "method": "speed_profile",
        "steering.wanted_angle.time": [0.0, 30.0, 60.0],
        "steering.wanted_angle.angle": [0.1, -0.3, 0.2],
        "steering.wanted_angle.interpolation": "linear",
    },
    "pedals from a speed on": {
        "method": "manoeuvre",
        "pedals.begin": True,
        "pedals.begin_time": 10.0,
        "pedals.begin_speed": 15.0,
        "pedals.time": [0.0, 1.0, 30.0],
        "pedals.drive_torque": [0.0, 500.0, -100.0],
        "pedals.brake_torque": [0.0, 0.0, 800.0],
    },
    "arcs": {
        "method": "path_follower",
        "path.shape": "arcs",
        "path.length": [20.0, 15.0, 30.0],
        "path.curvature": [0.05, 0.0, -0.1],
        "path.start_heading": 0.3,
        "pursuit.preview_time": 1.5,
    },
    "modes by the slope of the cycle": {
        "method": "pulse",
        "speed_profile.time": [0.0, 5.0, 30.0, 50.0, 60.0, 90.0],
        "speed_profile.speed": [0.0, 0.0, 20.0, 5.0, 0.0, 10.0],
        "band": 3.0,
        "vehicle.driven_wheels": ["rear_left", "rear_right"],
    },
    "windows": {
        "method": "tracking",
        "speed_profile.time": [0.0, 20.0, 80.0],
        "speed_profile.speed": [0.0, 15.0, 0.0],
        "modes.begin": [5.0, 40.0, 90.0],
        "modes.mode": ["traction", "regen", "stop"],
        "path.x": [0.0, 10.0, 20.0, 10.0],
        "path.y": [0.0, 5.0, -5.0, -10.0],
    },
    "a power on four wheels": {
        "method": "imposed_speed",
        "speed_profile.time": [0.0, 100.0],
        "speed_profile.speed": [1.0, 20.0],
        "level.factor": 2.0,
        "vehicle.driven_wheels": ["front_left", "front_right", "rear_left", "rear_right"],
    },
}


def slow(configuration: Configuration) -> Configuration:
    """The same driver, asked rarely."""
    return dataclasses.replace(
        configuration, common=dataclasses.replace(configuration.common, control_period=PERIOD)
    )


@pytest.mark.sampled
@pytest.mark.parametrize("choice", CHOICES)
def test_choices(choice):
    check_configuration(slow(configure("driver", CHOICES[choice])), steps=200)


@pytest.mark.parametrize("scenario", scenario_names())
@pytest.mark.sampled
def test_scenarios(scenario):
    for seed, configuration in enumerate(configurations_in(scenario, "driver")):
        check_configuration(slow(configuration), steps=200, seeds=[seed])
