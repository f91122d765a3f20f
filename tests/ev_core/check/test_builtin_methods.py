"""All built-in methods keep the contract, as they come.

The other tests here go through their parameters.
"""

from __future__ import annotations

import pytest

from documentation.own_methods import own_methods
from ev_core.check.method import check_method
from ev_msgs_py.contract.roles import ROLES
from ev_msgs_py.contract.wheels import WHEEL_NAMES

pytestmark = pytest.mark.slow

# Plain Python takes about 10 ms for a step of the planar plants of 1 ms; a control period has five
# or ten of those.
FEWER_STEPS = 15
# Laws of other sources need rear drives, or all four.
FRONT = {"vehicle.driven_wheels": ["front_left", "front_right"], "control_period": 0.005}
VALUES = {"circuits_on_can": FRONT, "can": FRONT | {"gear_ratio": 2.65}}
# identifiers and what is lost are not those of the other circuit
SIDED = ("circuits_on_can", "can")
REAR = ["rear_left", "rear_right"]
DRIVEN = {"slip_target": REAR, "wheel_speed": REAR, "axle_redistribution": list(WHEEL_NAMES)}
METHODS = [(role, name) for role in ROLES for name in own_methods(role)]
# They take 14 ms a period, and each of their 79 numbers goes to both ends of its range.
LONG = ("circuits", "circuits_with_flow")  # `circuits_on_can` drives the same machines


def test_methods_of_all_roles_are_there():
    assert {role for role, _ in METHODS} == set(ROLES)


@pytest.mark.parametrize(
    ("role", "name"),
    [
        pytest.param(*method, marks=pytest.mark.weekly if method[1] in LONG else ())
        for method in METHODS
    ],
)
def test_contract_is_kept(role, name):
    values = {"vehicle.driven_wheels": DRIVEN[name]} if name in DRIVEN else VALUES.get(name, {})
    check_method(
        role, name, values, steps=FEWER_STEPS if name.startswith("planar") else 40, whole=False
    )


@pytest.mark.parametrize(("role", "name"), METHODS)
def test_left_and_right_are_alike_to_all_of_them_but_those_of_the_bus(role, name):
    assert own_methods(role)[name].mirrored == (name not in SIDED)
