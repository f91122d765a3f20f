"""Speed by the free front wheels."""

from __future__ import annotations

import math

import pytest
from helpers.differentials import GE_NI

from ev_control.estimation.reference_speed import free_wheel_speed
from ev_core.methods.law import namespace
from ev_core.vehicle.car import car_numbers
from ev_msgs_py.contract.wheels import Wheels

CAR = namespace(car_numbers(GE_NI))


def test_free_wheel_speed_on_a_rolling_circle():
    """Wheels that roll on a circle of 10 m.

    The front middle moves with r L/sin(delta) along itself.
    """
    delta, r = math.atan(1.72 / 10), 0.5
    rim = r * 1.72 / math.sin(delta) / 0.32
    assert free_wheel_speed(CAR, Wheels.front(rim - 1, rim + 1), delta, r) == pytest.approx(
        5.0, rel=1e-12
    )


def test_error_of_a_rear_axle_that_slides():
    """Sliding by d = 2 deg at delta = 2 deg: u tan(delta) sin(d) = 0.12 % (docstring).

    1e-3 of that for u/cos(d).
    """
    u, delta, d, r = 10.0, math.radians(2.0), math.radians(2.0), 0.1
    v_front = -u * math.tan(d) + 1.72 * r  # the rear axle moves to the right
    rim = (u * math.cos(delta) + v_front * math.sin(delta)) / 0.32
    found = free_wheel_speed(CAR, Wheels.front(rim, rim), delta, r)
    assert u - found == pytest.approx(u * math.tan(delta) * math.sin(d), rel=1e-3)
