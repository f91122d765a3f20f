"""Traction control by the ratio of accelerations (dissertation, eq 1.4), by hand."""

from __future__ import annotations

import dataclasses
import math

import pytest
from helpers.traction import PERIOD, SPINNING, Control, spinning_at

from ev_msgs_py.contract.wheels import Wheels

ANY_GAIN = {"grip_slip": 0.0, "least_gain": 0.0}  # of the criterion alone


@pytest.mark.parametrize(("threshold", "falls"), [(0.4, True), (0.16, False)])
def test_the_printed_ratio_of_accelerations_is_always_undercut(threshold, falls):
    """A wheel that all but rolls at 3 m/s^2.

    w' = 9.4, a_x/w' = 0.319 m, below 0.4 but not below 0.16.
    """
    law = Control("acceleration_ratio", threshold=threshold, **ANY_GAIN)
    for n in range(100):
        rolling = Wheels.all(10.0 + 9.4 * PERIOD * n)
        torque = law.step(dataclasses.replace(SPINNING, speed=rolling, a_x=3.0)).front_left
    assert (torque < 1500.0) is falls


def test_limit_falls_and_rises_at_its_rates():
    """100 rad/s^2 against 1 m/s^2 is slip: from the request down by 8000 N m/s.

    Steady again, up by 500 N m/s.
    """
    law = Control("acceleration_ratio", filter_time=0.0, **ANY_GAIN)
    for n in range(5):
        torque = law.step(spinning_at(10.0 + 0.5 * n, 10.0)).front_left
    assert torque == pytest.approx(1500.0 - 4 * 8000.0 * PERIOD, rel=1e-12)
    for _ in range(3):
        torque = law.step(spinning_at(12.0, 10.0)).front_left
    assert torque == pytest.approx(1500.0 - 4 * 8000.0 * PERIOD + 3 * 500.0 * PERIOD, rel=1e-12)


def test_a_steady_spin_is_left_to_spin():
    """It sees slip that grows, not slip.

    30 rad/s over 10 rad/s, but steady, is no reason to limit.
    """
    law = Control("acceleration_ratio")
    for _ in range(100):
        assert law.step(spinning_at(30.0, 30.0)).front_left == 1500.0
    assert law.limits()[0] == math.inf


@pytest.mark.parametrize(("gained", "falls"), [(1.4, True), (1.1, False)])
def test_what_a_gripping_tyre_gains_is_no_slip(gained, falls):
    """Gain of 0.07 of 20 rad/s, 1.4 rad/s.

    A step of the torque winds the carcass up faster than the car follows.

    What has been gained 10 ms ago counts by 0.99, with a memory of 1 s.
    """
    law = Control("acceleration_ratio")
    for speed in (20.0, 20.0 + gained / 2, 20.0 + gained, 20.0 + gained * 1.1):
        torque = law.step(dataclasses.replace(spinning_at(speed, speed), a_x=0.0)).front_left
    assert (torque < 1500.0) is falls
