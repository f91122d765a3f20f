"""Torque by load and rolling resistance."""

from __future__ import annotations

import pytest
from helpers.differentials import DISSERTATION, FRONT_LOAD, REAR, Differential, Motion, on
from hypothesis import given
from hypothesis import strategies as st

from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.wheels import WHEEL_NAMES, Wheels
from ev_msgs_py.refusal import ParameterError

LAW = "load_proportional"


def test_torques_follow_the_loads_in_a_bend():
    """3 m/s^2 to the left: the loads m g b/(2 L) -+ k h m a_y/t, and with them the torques."""
    drive = Differential(LAW, DISSERTATION).step(Motion(torque=1000.0, a_y=3.0)).drive
    transfer = 0.51 * 0.55 * 2170.0 * 3.0 / 1.544
    left, right = FRONT_LOAD - transfer, FRONT_LOAD + transfer
    assert drive.front_left == pytest.approx(1000.0 * left / (left + right), rel=1e-12)
    assert drive.front_right == pytest.approx(1000.0 * right / (left + right), rel=1e-12)


def test_torques_follow_the_loads_when_accelerating():
    """2 m/s^2 move m h a_x/L from the front to the rear axle."""
    drive = (
        Differential(LAW, on(DISSERTATION, WHEEL_NAMES)).step(Motion(torque=1000.0, a_x=2.0)).drive
    )
    front = 2170.0 * (9.81 * 1.37649 - 0.55 * 2.0) / 2.699
    assert drive.front_left + drive.front_right == pytest.approx(
        1000.0 * front / (2170.0 * 9.81), rel=1e-12
    )


def test_rolling_resistance_counts_by_its_ratio():
    """1 : 3 in front, on a level road at rest; that of wheels without a motor does not count."""
    law = Differential(LAW, DISSERTATION, rolling_resistance=(2.0, 6.0, 1000.0, 1000.0))
    assert law.step(Motion(torque=1000.0)).drive == pytest.approx(
        (250.0, 750.0, 0.0, 0.0), rel=1e-14
    )


def test_wheels_that_carry_nothing_get_equal_torques():
    """All of the mass over the rear axle, the front wheels driven and lifted."""
    law = Differential(LAW, Vehicle(centre_of_mass_to_rear_axle=0.0))
    assert law.step(Motion(torque=1000.0, a_x=1.0)).drive == Wheels.front(500.0, 500.0)


@given(
    torque=st.floats(-3000.0, 3000.0),
    resistance=st.tuples(*[st.floats(0.01, 100.0)] * 4),
    along=st.floats(-8.0, 8.0),
    across=st.floats(-8.0, 8.0),
    driven=st.sampled_from((WHEEL_NAMES, REAR, DISSERTATION.driven_wheels)),
)
def test_no_wheel_works_against_the_others(torque, resistance, along, across, driven):
    law = Differential(LAW, on(DISSERTATION, driven), rolling_resistance=resistance)
    drive = law.step(Motion(torque=torque, a_x=along, a_y=across)).drive
    assert all(m * torque >= 0.0 for m in drive)
    assert sum(drive) == pytest.approx(torque, rel=1e-12, abs=1e-300)


def test_resistance_needs_one_number_for_each_wheel():
    with pytest.raises(
        ParameterError, match="rolling_resistance has 2 elements, expected one for each wheel, four"
    ):
        Differential(LAW, DISSERTATION, rolling_resistance=(1.0, 1.0))
