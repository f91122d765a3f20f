"""The kinematic plant keeps the contract at each depth of detail."""

from __future__ import annotations

import pytest

from ev_core.check.method import check_configuration
from ev_core.lockstep.configuration import configure
from ev_sim.drives.drive import DRIVE_MODELS

pytestmark = pytest.mark.slow

REAR = {"vehicle.driven_wheels": ["rear_left", "rear_right"], "vehicle.rear_track": 1.5}
PWM = {"drive": "switched", "switched.current_control": "pwm", "switched.pwm_frequency": 5e3}
# Choices, and how many steps plain Python can take in a second.
CHOICES = {
    "rear drive": ({**REAR, "sub_step": 4e-4, "initial_speed": -8.0}, 300),
    "averaged on a low bus": (
        {**REAR, "drive": "averaged", "bus_voltage": 200.0, "motor.resistance": 0.4},
        100,
    ),
    "switched on a low bus": (
        {"drive": "switched", "bus_voltage": 250.0, "initial_speed": 9.0},
        20,
    ),
    "pulse width modulation": (
        {**PWM, "switched.current_controller.bandwidth": 1000.0, "initial_speed": 5.0},
        20,
    ),
}
STEPS = {"ideal": 500, "averaged": 100, "switched": 20}


@pytest.mark.parametrize("drive", DRIVE_MODELS)
def test_each_depth_of_detail(drive):
    values = {"method": "kinematic", "drive": drive, "initial_speed": 5.0}
    check_configuration(configure("plant", values), steps=STEPS[drive])


@pytest.mark.parametrize("choice", CHOICES)
def test_choices(choice):
    values, steps = CHOICES[choice]
    check_configuration(configure("plant", {"method": "kinematic", **values}), steps=steps)
