"""Wheel loads from accelerations (dissertation, eqs 2.28 to 2.31)."""

from __future__ import annotations

import math

import pytest
from helpers.traction import car_of
from hypothesis import given
from hypothesis import strategies as st

from ev_control.estimation.wheel_dynamics import load_at_rest, wheel_load, wheel_loads
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.signals import InertialMeasurement

VEHICLE = Vehicle(
    mass=2170.0,
    wheelbase=2.699,
    front_track=1.544,
    rear_track=1.551,
    centre_of_mass_to_rear_axle=1.37649,
    centre_of_mass_height=0.55,
    front_roll_share=0.51,
)
CAR = car_of(VEHICLE)
WEIGHT = 2170.0 * 9.81


def test_loads_at_rest_by_hand():
    """The front axle carries b/L of the weight, 0.51."""
    front, rear = WEIGHT * 1.37649 / 2.699 / 2, WEIGHT * (2.699 - 1.37649) / 2.699 / 2
    assert [load_at_rest(CAR, i) for i in range(4)] == pytest.approx(
        [front, front, rear, rear], rel=1e-12
    )
    assert wheel_loads(CAR, InertialMeasurement(0.0, 0.0, 0.0)) == pytest.approx(
        (front, front, rear, rear), rel=1e-12
    )


def test_transfer_by_hand():
    """2 m/s^2 ahead take m h a/L = 884 N from the front axle.

    3 m/s^2 to the left put k h m a/t on the right wheels.
    """
    along = 2170.0 * 0.55 * 2.0 / 2.699 / 2
    across = (0.51 * 0.55 * 2170.0 * 3.0 / 1.544, 0.49 * 0.55 * 2170.0 * 3.0 / 1.551)
    signs = ((-1, -1, 0), (-1, 1, 0), (1, -1, 1), (1, 1, 1))
    found = wheel_loads(CAR, InertialMeasurement(0.0, 2.0, 3.0))
    for i, (ahead, side, axle) in enumerate(signs):
        assert found[i] - load_at_rest(CAR, i) == pytest.approx(
            ahead * along + side * across[axle], rel=1e-10
        )


@given(a_x=st.floats(-4.0, 4.0), a_y=st.floats(-4.0, 4.0))
def test_loads_add_up_to_the_weight(a_x, a_y):
    """Loads while no wheel lifts, which takes more than these accelerations."""
    assert math.fsum(wheel_loads(CAR, InertialMeasurement(0.0, a_x, a_y))) == pytest.approx(
        WEIGHT, rel=1e-12
    )


@given(a_x=st.floats(-20.0, 20.0), a_y=st.floats(-20.0, 20.0))
def test_left_and_right_mirror_to_the_bit(a_x, a_y):
    loads = wheel_loads(CAR, InertialMeasurement(0.0, a_x, a_y))
    mirrored = wheel_loads(CAR, InertialMeasurement(0.0, a_x, -a_y))
    assert loads == (mirrored[1], mirrored[0], mirrored[3], mirrored[2])


def test_no_wheel_lifts_below_a_tenth_of_its_load():
    assert wheel_load(CAR, 0, 0.0, 50.0) == 0.1 * load_at_rest(CAR, 0)
