"""Traction control by the largest torque that the tyre can transmit (dissertation, eq 1.7), by hand."""

from __future__ import annotations

import pytest
from traction import Control, spinning_at


@pytest.mark.parametrize("relaxation", [0.5, 0.9])
def test_transmissible_torque_by_hand(relaxation):
    """With M_w = 1500, w' = 100, J = 1.658 + 7.4^2 0.02 = 2.7532: r F_d = 1224.68, times 1 + J/(alpha 1085 0.32^2)."""
    law = Control("maximum_transmissible_torque", filter_time=0.0, relaxation=relaxation)
    for speed in (10.0, 10.5):
        torque = law.step(spinning_at(speed, speed)).front_left
    assert torque == pytest.approx(1224.68 * (1 + 2.7532 / (relaxation * 1085.0 * 0.32**2)), rel=1e-12)


def test_a_wheel_that_follows_the_car_is_not_limited():
    """1 m/s^2 of the car is 3.125 rad/s^2 of a wheel that rolls; alpha times that, and the margin, is what it may."""
    law = Control("maximum_transmissible_torque", filter_time=0.0)
    for n in range(100):
        speed = 10.0 + 3.125 * 0.005 * n
        assert law.step(spinning_at(speed, speed)).front_left == 1500.0


def test_limit_rises_slowly_once_the_wheel_follows():
    """By 1000 N m/s from the last one of eq 1.7."""
    law = Control("maximum_transmissible_torque", filter_time=0.0)
    for speed in (10.0, 10.5):
        limit = law.step(spinning_at(speed, speed)).front_left
    for n in range(1, 11):
        assert law.step(spinning_at(10.5, 10.5)).front_left == pytest.approx(limit + 5.0 * n, rel=1e-12)
