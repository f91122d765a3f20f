"""Locking that grows with the speed difference."""

from __future__ import annotations

import pytest
from helpers.differentials import DISSERTATION, Differential, Motion

from ev_msgs_py.contract.wheels import Wheels


@pytest.mark.parametrize("torque", [800.0, -800.0])
@pytest.mark.parametrize("difference", [20.0, -20.0])
def test_locked_torques_are_as_3_to_2(torque, difference):
    """K = M_slow/M_fast = 1.5 (section 3.4): 480 and 320 N m.

    A braking wheel is held back by the faster one.
    """
    law = Differential("limited_slip_variable", DISSERTATION)
    drive = law.step(Motion(torque=torque, speeds=Wheels.front(30.0 + difference, 30.0))).drive
    fast, slow = drive[:2] if difference > 0 else drive[1::-1]
    assert (slow, fast) == pytest.approx(
        (480.0, 320.0) if torque > 0 else (-320.0, -480.0), rel=1e-14
    )


@pytest.mark.parametrize(
    ("difference", "ratio"), [(0.0, 1.0), (2.5, 1.25), (4.0, 1.4), (5.0, 1.5), (50.0, 1.5)]
)
def test_locking_grows_with_the_speed_difference(difference, ratio):
    """K = 1..1.5 (section 3.4), linear up to 5 rad/s (assumption)."""
    law = Differential("limited_slip_variable", DISSERTATION)
    drive = law.step(Motion(torque=800.0, speeds=Wheels.front(30.0, 30.0 + difference))).drive
    assert drive.front_left / drive.front_right == pytest.approx(ratio, rel=1e-14)
