"""Torque between the axles and the rear wheels by the slip angles; computed by hand."""

from __future__ import annotations

import dataclasses

import pytest
from differentials import REAR, ZHILEYKIN, Differential, Motion, on, sequences
from hypothesis import given, settings
from hypothesis import strategies as st

from ev_msgs_py.parameters.declaration import ParameterError

LAW = "axle_redistribution"


def made(**changed) -> Differential:
    return Differential(LAW, ZHILEYKIN, **changed)


def test_front_slides_by_cos_phi():
    """With cos(phi) = 0.6 and k = 0.5, h = 0.3; q = 2.7*0.1*0.3/(2*1.55*0.7) = 0.0373, by hand."""
    drive = made(k=0.5).step(Motion(torque=1000.0, a_x=0.6, a_y=0.8).steered(0.1)).drive
    q = 2.7 * 0.1 * 0.3 / (2 * 1.55 * 0.7)
    assert drive == pytest.approx((150, 150, 350 * (1 + q), 350 * (1 - q)), rel=1e-12)


def test_rear_slides_by_one_minus_cos_phi():
    """Sliding to the right at 2 m/s puts 0.4 rad on the rear axle and 0.3 on the front: h = k (1 - 0.6) = 0.2."""
    drive = made(k=0.5).step(Motion(torque=1000.0, v=-2.0, a_x=0.6, a_y=0.8).steered(-0.1)).drive
    assert drive.front_left + drive.front_right == pytest.approx(200.0, rel=1e-12)


@pytest.mark.parametrize(("branch", "share"), [("front", 0.3), ("rear", 0.2)])
def test_equal_slip_angles_leave_the_first_branch(branch, share):
    """Straight ahead with cos(phi) = 0.6: k 0.6 = 0.3 in front, or k (1 - 0.6) = 0.2."""
    drive = made(k=0.5, first_branch=branch).step(Motion(torque=1000.0, a_x=0.6, a_y=0.8)).drive
    assert drive.front_left + drive.front_right == pytest.approx(1000.0 * share, rel=1e-12)


def test_front_share_ends_at_one_half():
    assert made().step(Motion(torque=1000.0, a_x=1.0)).drive == (250.0,) * 4


@pytest.mark.parametrize("motion", [Motion(torque=-400.0, a_x=-2.0), Motion(torque=100.0, brake=50.0)])
def test_braking_puts_all_torque_on_the_rear_axle(motion):
    assert made().step(motion).drive == (0.0, 0.0, motion.torque / 2, motion.torque / 2)


def test_deadbands_hold_branch_and_direction():
    """Straight ahead noise of the slip angles within +-0.004 rad and of the acceleration changes no torque."""
    law = made()
    first = law.step(Motion(torque=1000.0, a_x=0.3))
    for sign in (1, -1, 1, -1):
        noisy = Motion(torque=1000.0, v=0.01, r=sign * 0.005, a_x=sign * 0.02, a_y=0.05)
        assert law.step(noisy) == first


@settings(deadline=None, max_examples=60)
@given(sequence=sequences, most=st.floats(0.0, 0.9), source=st.sampled_from(("truth", "estimated")))
def test_no_wheel_works_against_the_others_and_the_front_share_is_limited(sequence, most, source):
    law = made(largest_front_share=most, source=source)
    for motion in sequence:
        drive = law.step(motion).drive
        assert all(torque * motion.torque >= 0.0 for torque in drive)
        assert sum(drive) == pytest.approx(motion.torque, rel=1e-12, abs=1e-300)
        assert abs(drive.front_left + drive.front_right) <= most * abs(motion.torque) * (1 + 1e-14)


def test_truth_needs_no_observer():
    """What only the observer looks at, wheel speeds, changes nothing."""
    motion = Motion(torque=1000.0, r=0.3, v=0.2, a_x=0.6, a_y=0.8).steered(0.1)
    spinning = dataclasses.replace(motion, speeds=motion.speeds._replace(front_left=90.0))
    assert made().step(motion) == made().step(spinning)


def test_a_car_without_four_driven_wheels_is_refused():
    line = "axle_redistribution needs front_left, front_right, rear_left and rear_right among the driven wheels"
    with pytest.raises(ParameterError, match=line):
        Differential(LAW, on(ZHILEYKIN, REAR))
