"""Traction control by the ratio of accelerations (dissertation, eq 1.4), by hand."""

from __future__ import annotations

import dataclasses
import math

import pytest
from traction import PERIOD, SPINNING, Control, spinning_at

from ev_msgs_py.contract.wheels import Wheels


@pytest.mark.parametrize(("threshold", "falls"), [(0.4, True), (0.16, False)])
def test_the_printed_ratio_of_accelerations_is_always_undercut(threshold, falls):
    """A wheel that rolls without any slip at 3 m/s^2: w' = 9.375, a_x/w' = 0.32 m, below 0.4 but not below 0.16."""
    law = Control("acceleration_ratio", threshold=threshold)
    for n in range(100):
        rolling = Wheels.all(10.0 + 9.375 * PERIOD * n)
        torque = law.step(dataclasses.replace(SPINNING, speed=rolling, a_x=3.0)).front_left
    assert (torque < 1500.0) is falls


def test_limit_falls_and_rises_at_its_rates():
    """100 rad/s^2 against 1 m/s^2 is slip: from the request down by 8000 N m/s; steady again, up by 500 N m/s."""
    law = Control("acceleration_ratio", filter_time=0.0)
    for n in range(5):
        torque = law.step(spinning_at(10.0 + 0.5 * n, 10.0)).front_left
    assert torque == pytest.approx(1500.0 - 4 * 8000.0 * PERIOD, rel=1e-12)
    for _ in range(3):
        torque = law.step(spinning_at(12.0, 10.0)).front_left
    assert torque == pytest.approx(1500.0 - 4 * 8000.0 * PERIOD + 3 * 500.0 * PERIOD, rel=1e-12)


def test_a_steady_spin_is_left_to_spin():
    """It sees slip that grows, not slip: 30 rad/s over 10 rad/s, but steady, is no reason to limit."""
    law = Control("acceleration_ratio")
    for _ in range(100):
        assert law.step(spinning_at(30.0, 30.0)).front_left == 1500.0
    assert law.limits()[0] == math.inf
