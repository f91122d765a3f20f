"""Properties of more than one steering column."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.signal
from column.columns import CAR, RATIO, B, Column, J, K, wheels_with
from hypothesis import given
from hypothesis import strategies as st

from ev_core.lockstep.finding import find_method
from ev_msgs_py.contract.signals import SteeringColumnState


@pytest.mark.parametrize("name", ["manual", "powered", "by_wire"])
def test_columns_are_registered_and_start_at_rest(name):
    column = find_method("steering_column", name)
    assert column.factory(column.parameters(), CAR, 0.01).outputs() == (
        SteeringColumnState(0.0, 0.0, 0.0, 0.0, 0.0),
    )


@pytest.mark.parametrize("name", ["manual", "powered"])
def test_step_of_hand_torque_is_the_exact_step_response(name):
    """Eq 6 with M_b = 5 N m by scipy.

    The steps are exact at any period, so only rounding is left.
    """
    for period in (0.001, 0.01):
        column = Column(name, period)
        time = np.arange(round(10 / period) + 1) * period
        angle = [0.0] + [column.advance(5.0).road_wheel_angle for _ in time[1:]]
        _, exact = scipy.signal.step(
            scipy.signal.TransferFunction([RATIO * 5.0], [J, B, K]), T=time
        )
        assert angle == pytest.approx(exact, abs=1e-10)


def test_only_the_manual_column_ignores_the_drives_and_only_by_wire_the_hands():
    for name in ("powered", "by_wire"):
        assert Column(name).advance(0.0, wheels_with(difference=10.0)).road_wheel_angle > 0.0
    for name in ("manual", "powered"):
        assert Column(name).advance(1.0).road_wheel_angle > 0.0
    by_wire = Column("by_wire").advance(1.0)
    assert by_wire.road_wheel_angle == 0.0
    assert by_wire.angle > 0.0


@pytest.mark.sampled
@pytest.mark.parametrize("name", ["manual", "powered", "by_wire"])
@pytest.mark.parametrize("period", [0.001, 0.01])
def test_stick_holds_exactly_for_a_minute(name, period):
    """Turned and let go, friction holds the wheels off centre: not a bit changes in 60 s."""
    column = Column(name, period, dry_friction=20.0)
    for _ in range(round(3 / period)):
        column.advance(3.0, wheels_with(difference=15.0))
    for _ in range(round(2 / period)):
        held = column.advance()
    assert abs(held.road_wheel_angle) > 0.05
    assert held.road_wheel_rate == 0.0
    for _ in range(round(60 / period)):
        state = column.advance()
        assert state.road_wheel_angle == held.road_wheel_angle
        assert state.road_wheel_rate == 0.0


@given(
    torques=st.lists(
        st.tuples(st.floats(-8.0, 8.0), st.floats(-50.0, 50.0)), min_size=1, max_size=30
    )
)
@pytest.mark.parametrize("name", ["powered", "by_wire"])
def test_columns_mirror_to_the_bit(name, torques):
    changed = {"dry_friction": 5.0, "wheel_inertia": 0.5, "max_angle": 0.6}
    column, mirror = (Column(name, 0.01, **changed) for _ in range(2))
    for hand_torque, difference in torques:
        state = column.advance(hand_torque, wheels_with(difference, difference / 10))
        mirrored = mirror.advance(-hand_torque, wheels_with(-difference, -difference / 10))
        assert mirrored == tuple(-value for value in state)
