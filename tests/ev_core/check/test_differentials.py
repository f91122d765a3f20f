"""Every electronic differential keeps the contract, whatever its parameters are."""

from __future__ import annotations

import pytest
from helpers.differentials import REAR, ROLE

from ev_core.check.method import check_configuration
from ev_core.check.reached import reached
from ev_core.check.stepping import Subject
from ev_core.lockstep.configuration import configure
from ev_core.methods.register import methods_of
from ev_msgs_py.contract.wheels import WHEEL_NAMES

pytestmark = pytest.mark.slow

STEPS = 100
# in plain Python a step of its optimiser takes a tenth of a second
FEWER = {"direct_yaw_moment": 40}
ALL_DRIVEN = {"vehicle.driven_wheels": list(WHEEL_NAMES)}
REAR_DRIVEN = {"vehicle.driven_wheels": list(REAR)}
NEEDED = {"axle_redistribution": ALL_DRIVEN, "slip_target": REAR_DRIVEN, "wheel_speed": REAR_DRIVEN}
CHOICES: dict[str, tuple[dict, ...]] = {
    "adaptive": (
        {"redistribute": True},
        {"redistribute": True, "filter_time": 0.0, "control_period": 0.005},
        {"redistribute": True, **ALL_DRIVEN},
    ),
    "adhesion_share": (
        {"friction": "estimated"},
        {
            "friction": "estimated",
            "estimate.learning_slip": 0.05,
            "error_factor": 1.5,
            **REAR_DRIVEN,
        },
        {"friction": "estimated", "estimate.filter_time": 0.0, **ALL_DRIVEN},
        {"friction": "estimated", "estimate.reference.source": "observer"},
    ),
    "axle_redistribution": (
        {"source": "estimated", "k": 0.5, "first_branch": "rear"},
        {"source": "estimated", "observer.kinematic_share": 0.3, "slip_angle_deadband": 0.0},
        {"acceleration_deadband": 5.0, "largest_front_share": 0.9, "rear_wheels": "by_geometry"},
        {"factor": "equality", "second_branch": "rear_share", "braking": "command"},
        {"factor": "inertia", "second_branch": "derived", "speed_deadband": 0.0},
    ),
    "course_stability": (
        {"first": "yaw", "wish": "angle", "understeer": 0.002},
        {"against": "both", "yaw_gain": 5000.0, "error_factor": 3.0},
    ),
    "direct_yaw_moment": (
        {
            "reference": "sideslip_limit",
            "controller": "super_twisting",
            "allocation": "least_squares",
            **ALL_DRIVEN,
        },
        {
            "reference": "neutral",
            "controller": "lqr",
            "allocation": "load",
            "estimation": "estimated",
            **REAR_DRIVEN,
        },
        {
            "controller": "suboptimal",
            "allocation": "least_loss",
            "estimation": "estimated",
            "vehicle.motor.map_speed": [10.0, 1000.0],
            "vehicle.motor.map_torque": [1.0, 200.0],
            "vehicle.motor.map_efficiency": [0.6, 0.8, 0.85, 0.95],
            **ALL_DRIVEN,
        },
    ),
    "drive_by_wire": ({"gain": 20.0, "brake.front_share": 0.3}, ALL_DRIVEN),
    "equal_torque": ({"vehicle.driven_wheels": ["rear_left"]}, ALL_DRIVEN),
    "limited_slip": ({"locking_ratio": 3.0, "locking_speed": 20.0}, ALL_DRIVEN),
    "limited_slip_variable": (
        {"largest_locking_ratio": 3.0, "full_locking_speed": 50.0},
        ALL_DRIVEN,
    ),
    "load_proportional": ({"rolling_resistance": [1.0, 2.0, 3.0, 4.0], **ALL_DRIVEN}, REAR_DRIVEN),
    "open_differential": ({"vehicle.motor.peak_torque": 50.0}, ALL_DRIVEN),
    "power_steering": ({"gamma": 1.0, "k_ck": 1.0}, ALL_DRIVEN),
    "slip_target": (
        {"source": "estimated"},
        {"reading": "offset", "boundary_layer": False},
        {"reading": "increment", "layer_width": 0.5, "largest_correction": 1.0},
        {"road.target": "fitted", "road.peak.window": 0.05, "road.share": 0.5},
    ),
    "steer_by_wire": (
        {"disturbance_rate": 0.0},
        {"max_torque_difference": 5.0, "damping_ratio": 0.3},
    ),
    "steering_correction": (
        {"axle": "rear", **ALL_DRIVEN},
        REAR_DRIVEN,
        {"gain": 10.0, "largest_correction": 0.2},
    ),
    "wheel_speed": ({"mean": "speed"}, {"proportional_gain": 0.0, "largest_correction": 1.0}),
}


def test_every_law_has_choices():
    assert set(CHOICES) == set(methods_of(ROLE))


@pytest.mark.sampled  # test_builtin_methods has each law as it comes
@pytest.mark.parametrize(
    ("name", "changed"),
    [(name, changed) for name, choices in CHOICES.items() for changed in ({}, *choices)],
)
def test_contract_is_kept(name, changed):
    configuration = configure(ROLE, {"method": name, **NEEDED.get(name, {}), **changed})
    check_configuration(configuration, steps=FEWER.get(name, STEPS))


@pytest.mark.sampled
@pytest.mark.parametrize("name", CHOICES)
def test_the_inputs_reach_every_function(name):
    """One of the choices at least calls each function: what is never called is never checked."""
    settings = [
        {"method": name, **NEEDED.get(name, {}), **changed} for changed in ({}, *CHOICES[name])
    ]
    subjects = [Subject(configure(ROLE, values), False, STEPS) for values in settings]
    assert set.intersection(*(set(reached(each, [1]).never_called) for each in subjects)) == set()
