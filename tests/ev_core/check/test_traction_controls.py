"""Every traction control keeps the contract, whatever its parameters are.

At random, and in launches.
"""

from __future__ import annotations

import pytest
from helpers.traction import FASTEST, METHODS, SPEED_MODE, configured

from ev_core.check.method import check_configuration
from ev_core.check.reached import reached
from ev_core.check.stepping import RandomInputs, Subject
from ev_core.methods.method_record import create
from ev_msgs_py.contract.wheels import WHEEL_NAMES

pytestmark = pytest.mark.slow

SEED = 1
STEPS = 300
# of laws with a long state: every number of it is compared in every step
FEWER_STEPS = 200
ALL_DRIVEN = {"vehicle.driven_wheels": list(WHEEL_NAMES)}
REAR_DRIVEN = {"vehicle.driven_wheels": ["rear_left", "rear_right"]}
ONE_DRIVEN = {"vehicle.driven_wheels": ["front_left"]}
CHOICES: dict[str, tuple[dict, ...]] = {
    "acceleration_ratio": (
        {"threshold": 0.3, "filter_time": 0.0, "reference.source": "observer"},
        ALL_DRIVEN,
    ),
    "adhesion_limit": (
        {
            "learning_slip": 0.05,
            "use": 0.8,
            "vehicle.front_roll_share": 0.3,
            "vehicle.rear_track": 1.3,
        },
        {"reference.source": "observer", "filter_time": 0.0, **REAR_DRIVEN},
        ALL_DRIVEN,
    ),
    "expected_signal": ({"filter_time": 0.0, "rate": 200.0, "least_slip": 0.05}, ALL_DRIVEN),
    "feedback_linearisation": (
        {"rate": 60.0, "road_filter": 0.0, "regulator.slip.observer": "corrected_derivative"},
        {"regulator.target": 0.05, **ALL_DRIVEN},
    ),
    "fuzzy": (
        {"filter_time": 0.0, "error_width": 0.02, "regulator.slip.observer": "derivative"},
        {"rate_width": 0.5, "regulator.release": 0.0, **REAR_DRIVEN},
    ),
    "held_torque": ({"low": 0.05, "high": 0.1, **ALL_DRIVEN},),
    "least_squares": (
        {
            "window": 0.05,
            "template": "square",
            "largest_error": 0.5,
            "use": 0.8,
            "hits": 1,
            "spread": 0.5,
            "hold": 0.0,
            "probe": 10.0,
        },
        {"offset": 0.01, "backstop": 0.1, "reference.source": "observer", **REAR_DRIVEN},
        {"control_period": 0.01, "window": 2.0, **ALL_DRIVEN},
    ),
    "least_squares_literal": (
        {"samples": 2, "template": "square", **REAR_DRIVEN},
        {"samples": 60, **ALL_DRIVEN},
    ),
    "maximum_transmissible_torque": (
        {"relaxation": 0.5, "filter_time": 0.0},
        {"margin": 0.0, **ALL_DRIVEN},
    ),
    "modified_lambda": (
        {"filter_time": 0.0, "rate": 40.0, "regulator.slip.observer": "derivative"},
        REAR_DRIVEN,
    ),
    "pi_slip": (
        {"regulator.slip.observer": "derivative", "regulator.target": 0.05},
        {
            "regulator.slip.observer": "corrected_derivative",
            "regulator.slip.correction": 0.5,
            **ALL_DRIVEN,
        },
        {"regulator.slip.observer": "disturbance", "regulator.slip.filter_time": 0.0, **ONE_DRIVEN},
        {
            "natural_frequency": 50.0,
            "damping_ratio": 0.3,
            "regulator.reference.gripping_rate": 100.0,
            **ALL_DRIVEN,
        },
    ),
    "slip_window": (
        {"low": 0.05, "high": 0.05, "trend": 0.0, "side_force.correction": "ellipse"},
        {"slowest": 10.0, "rise": 1e5, **ALL_DRIVEN},
    ),
    "speed_by_acceleration_ratio": ({"criterion.threshold": 0.3, "raising": 500.0}, REAR_DRIVEN),
    "speed_by_slip": (
        {"thresholds.low": 0.05, "thresholds.high": 0.08, "release": 0.0, **ALL_DRIVEN},
    ),
    "speed_corridor": (
        {"regime": "winter", "lowering": 2000.0},
        {"regime": "terrain", **ALL_DRIVEN},
    ),
}
CASES = [(name, changed) for name, choices in CHOICES.items() for changed in ({}, *choices)]


def steps_of(name: str) -> int:
    return FEWER_STEPS if name.startswith("least_squares") else STEPS


def test_every_law_has_choices():
    assert set(CHOICES) == {*METHODS, *SPEED_MODE}


@pytest.mark.sampled  # test_builtin_methods has each law as it comes
@pytest.mark.parametrize(("name", "changed"), CASES)
def test_contract_is_kept(name, changed):
    """Long enough to fill windows and to limit wheels."""
    check_configuration(configured(name, **changed), steps=steps_of(name), seeds=[SEED])


@pytest.mark.sampled
@pytest.mark.parametrize("name", CHOICES)
def test_the_inputs_reach_every_function(name):
    """One of the choices at least calls each function: what is never called is never checked."""
    subjects = [
        Subject(configured(name, **changed), False, STEPS) for changed in ({}, *CHOICES[name])
    ]
    assert (
        set.intersection(*(set(reached(each, [SEED]).never_called) for each in subjects)) == set()
    )


@pytest.mark.sampled
@pytest.mark.parametrize(("name", "changed"), CASES)
def test_launches_are_limited(name, changed):
    """The launches of the test above reach the law.

    It takes torque from a wheel in at least 20 of their steps.
    """
    c = configured(name, **changed)
    law = create(c.method, c.parameters, c.common.vehicle, c.common.control_period)
    launches = RandomInputs(c.method.reads, SEED, c.common.control_period)
    limited = 0
    for _ in range(2 * STEPS):
        request, *others = launches.next()
        answer = law.step(request, *others)
        if name in SPEED_MODE:
            limited += min(abs(speed) for speed in answer[1].speed) < FASTEST
        else:
            limited += answer.drive != request.drive
    assert limited >= 20
