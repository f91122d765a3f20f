"""The column that only the driver turns (Shchur 2019, eqs 3 and 6)."""

from __future__ import annotations

import math

import numpy as np
import pytest
from column.columns import RATIO, B, Column, J, K

from ev_sim.steering.friction_oscillator import oscillated, oscillator


def test_object_reaches_the_values_that_follow_from_the_paper():
    """Fig 1a, curve 1: steady 1.2308 rad (5 i/k_p), overshoot 40.3 %.

    The bands are those of the other values.
    """
    column = Column("manual")
    angle = np.array([column.advance(5.0).road_wheel_angle for _ in range(15000)])
    assert angle[-1] == pytest.approx(1.2308, rel=0.005)
    assert (angle.max() / angle[-1] - 1) * 100 == pytest.approx(40.3, abs=1.0)


def test_holding_30_degrees_by_hand():
    """2.127 N m at the steering wheel: k_p delta / i; the printed digits."""
    column = Column("manual")
    for _ in range(20000):
        state = column.advance(2.127)
    assert math.degrees(state.road_wheel_angle) == pytest.approx(30.0, rel=0.0005)
    assert state.angle == RATIO * state.road_wheel_angle
    assert state.hand_torque == 2.127


def test_end_stop_takes_the_motion_and_lets_go():
    """Against the stop at 0.5 rad it rests there exactly.

    Released it comes back as from rest at 0.5 rad.

    0.5 (c + s decay) of the free motion is the exact step response; only rounding differs.
    """
    column = Column("manual", max_angle=0.5)
    for _ in range(1000):
        state = column.advance(10.0)
    assert (state.road_wheel_angle, state.road_wheel_rate) == (0.5, 0.0)
    free = oscillator(J, B, K, 0.0, 1e6, 0.001)
    angle, rate = 0.5, 0.0
    for _ in range(500):
        state = column.advance()
        angle, rate = oscillated(free, angle, rate, 0.0)
        assert (state.road_wheel_angle, state.road_wheel_rate) == (angle, rate)
