"""Constant locking."""

from __future__ import annotations

import math

import pytest
from helpers.differentials import DISSERTATION, Differential, Motion, on

from ev_msgs_py.contract.wheels import WHEEL_NAMES, Wheels


@pytest.mark.parametrize("torque", [800.0, -800.0])
@pytest.mark.parametrize("difference", [20.0, -20.0])
def test_locked_torques_are_as_3_to_2(torque, difference):
    """K = M_slow/M_fast = 1.5 (section 3.3): 480 and 320 N m.

    A braking wheel is held back by the faster one.
    """
    law = Differential("limited_slip", DISSERTATION)
    drive = law.step(Motion(torque=torque, speeds=Wheels.front(30.0 + difference, 30.0))).drive
    fast, slow = drive[:2] if difference > 0 else drive[1::-1]
    assert (slow, fast) == pytest.approx(
        (480.0, 320.0) if torque > 0 else (-320.0, -480.0), rel=1e-14
    )


def test_locking_is_smooth_around_equal_speeds():
    """A difference of 0.5 rad/s gives tanh(1) of the locking share 0.2: 61 N m of 800 N m move."""
    law = Differential("limited_slip", DISSERTATION)
    drive = law.step(Motion(torque=800.0, speeds=Wheels.front(30.5, 30.0))).drive
    assert drive.front_right - 400.0 == pytest.approx(400.0 * 0.2 * math.tanh(1.0), rel=1e-12)


def test_axles_are_locked_on_their_own():
    """1600 N m over four wheels, 400 N m each: the front ones spin left, the rear ones right."""
    law = Differential("limited_slip", on(DISSERTATION, WHEEL_NAMES))
    drive = law.step(Motion(torque=1600.0, speeds=Wheels(50.0, 30.0, 30.0, 50.0))).drive
    assert drive == pytest.approx((320.0, 480.0, 480.0, 320.0), rel=1e-14)


def test_an_axle_with_one_motor_has_nothing_to_lock():
    law = Differential("limited_slip", on(DISSERTATION, ("front_left", "front_right", "rear_left")))
    drive = law.step(Motion(torque=1200.0, speeds=Wheels(30.0, 30.0, 50.0, 30.0))).drive
    assert drive == (400.0, 400.0, 400.0, 0.0)
