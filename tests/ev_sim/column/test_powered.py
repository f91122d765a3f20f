"""The column that driver and front drives turn (Shchur 2019, eq 3)."""

from __future__ import annotations

import pytest
from column.columns import LEVER, Column, K, wheels_with


def test_drive_torque_difference_turns_the_wheels():
    """Equilibrium is k_p delta = d/(2 r_k) (M_R - M_L).

    After 20 s the free motion has decayed to e^-27.
    """
    column = Column("powered")
    for _ in range(20000):
        state = column.advance(0.0, wheels_with(difference=10.0))
    assert state.road_wheel_angle == pytest.approx(LEVER * 10.0 / K, rel=1e-9)


def test_inertia_of_the_wheels_works_against_their_acceleration():
    """The J_k term of eq 3.

    The speed difference grows by 0.5 rad/s in 10 ms, so 1 kg m^2 takes 50 N m of the drives.

    To the bit: both columns get the same numbers, 50 N m of torque difference less or 0.5/0.01
    rad/s^2.
    """
    with_inertia = Column("powered", 0.01, wheel_inertia=1.0)
    without = Column("powered", 0.01)
    assert with_inertia.advance(0.0, wheels_with(60.0, 0.5)) == without.advance(
        0.0, wheels_with(10.0)
    )
    assert with_inertia.advance(0.0, wheels_with(60.0, 0.5)) == without.advance(
        0.0, wheels_with(60.0)
    )
