"""Torque between the axles and the rear wheels by the slip angles; computed by hand."""

from __future__ import annotations

import dataclasses
import math

import pytest
from helpers.differentials import REAR, ZHILEYKIN, Differential, Motion, on, sequences
from hypothesis import given
from hypothesis import strategies as st

from ev_msgs_py.contract.wheels import Wheels
from ev_msgs_py.refusal import ParameterError

LAW = "axle_redistribution"


def made(**changed) -> Differential:
    return Differential(LAW, ZHILEYKIN, **changed)


# 2 J_z/(m L^2) of the car [1], by hand.
INERTIA = 2 * 4200.0 / (2400.0 * 2.7**2)
RIGHT_IS_SLOWER = Wheels(20.0, 20.0, 20.0, 19.8)


def front(drive: Wheels) -> float:
    """Torque of the front axle [N m]."""
    assert drive.front_left == drive.front_right
    return drive.front_left + drive.front_right


def test_front_slides_by_cos_phi():
    """Angle with cos(phi) = 0.6 and k = 0.5: h = 0.3.

    q = 2.7*0.1*0.3/(2*1.55*0.7) = 0.0373, by hand.
    """
    drive = (
        made(k=0.5, rear_wheels="by_geometry")
        .step(Motion(torque=1000.0, a_x=0.6, a_y=0.8).steered(0.1))
        .drive
    )
    q = 2.7 * 0.1 * 0.3 / (2 * 1.55 * 0.7)
    assert drive == pytest.approx((150, 150, 350 * (1 + q), 350 * (1 - q)), rel=1e-12)


# 0.4 rad at the rear axle, 0.3 at the front
SLIDING = Motion(torque=1000.0, v=-2.0, a_x=0.6, a_y=0.8).steered(-0.1)


@pytest.mark.parametrize(
    ("branch", "share"), [("printed", 0.2), ("derived", 0.3), ("rear_share", 0.5)]
)
def test_rear_slides_by_three_readings(branch, share):
    """Factor k = 0.5.

    k (1 - 0.6) as printed, k 0.6 as derived, 1 - k 0.6 = 0.7, limited to a half.
    """
    assert front(made(k=0.5, second_branch=branch).step(SLIDING).drive) == pytest.approx(
        1000.0 * share, rel=1e-12
    )


def test_rear_share_is_not_always_limited():
    drive = made(k=1.0, second_branch="rear_share").step(SLIDING).drive
    assert front(drive) == pytest.approx(400.0, rel=1e-12)  # 1 - 0.6


@pytest.mark.parametrize(("branch", "share"), [("front", 0.3), ("rear", 0.2)])
def test_equal_slip_angles_leave_the_first_branch(branch, share):
    """Straight ahead with cos(phi) = 0.6: k 0.6 = 0.3 in front, or k (1 - 0.6) = 0.2."""
    drive = made(k=0.5, first_branch=branch).step(Motion(torque=1000.0, a_x=0.6, a_y=0.8)).drive
    assert front(drive) == pytest.approx(1000.0 * share, rel=1e-12)


def test_front_share_ends_at_one_half():
    assert made().step(Motion(torque=1000.0, a_x=1.0)).drive == (250.0,) * 4


@pytest.mark.parametrize("braking", ["straight", "deceleration", "command"])
@pytest.mark.parametrize("factor", ["given", "equality"])
def test_speeding_up_backwards_is_no_braking(braking, factor):
    """Torque, acceleration and speeds change their sign in reverse, and nothing else.

    Slowing down is all rear.
    """
    steered = Motion(torque=1000.0, a_x=0.6, a_y=0.8, speeds=RIGHT_IS_SLOWER).steered(0.1)
    back = dataclasses.replace(
        steered, torque=-1000.0, a_x=-0.6, speeds=Wheels(*(-each for each in RIGHT_IS_SLOWER))
    )
    forwards = made(braking=braking, factor=factor, k=0.5).step(steered).drive
    assert front(forwards) > 0.0
    assert made(braking=braking, factor=factor, k=0.5).step(back).drive == tuple(
        -each for each in forwards
    )
    slows = dataclasses.replace(back, torque=1000.0, a_x=0.6, a_y=0.0)
    assert front(made(braking=braking, factor=factor, k=0.5).step(slows).drive) == 0.0


def test_factor_by_inertia_is_that_of_a_car_without_resistance():
    """K = 2 J_z/(m L^2) = 0.48.

    The equality gives the same where X = m j: 1000 N m at 0.35 m and 2400 kg.
    """
    motion = Motion(torque=1000.0, a_x=1000.0 / 0.35 / 2400.0)
    assert front(made(factor="inertia").step(motion).drive) == pytest.approx(
        1000.0 * INERTIA, rel=1e-12
    )
    assert front(made(factor="equality").step(motion).drive) == pytest.approx(
        1000.0 * INERTIA, rel=1e-12
    )


@pytest.mark.parametrize("a_y", [0.0, 0.5, 3.0])
def test_as_an_equality_eq_4_does_not_depend_on_the_lateral_acceleration(a_y):
    """Eq 4, h X = 2 J_z j cos(phi)/L^2 has j cos(phi) = a_x.

    With X = 1000/0.35 N and a_x = 0.6, h = 0.242.
    """
    share = 2 * 4200.0 * 0.6 / (2.7**2 * 1000.0 / 0.35)
    drive = made(factor="equality").step(Motion(torque=1000.0, a_x=0.6, a_y=a_y)).drive
    assert front(drive) == pytest.approx(1000.0 * share, rel=1e-12)


def test_without_drive_force_the_equality_stays_finite():
    assert made(factor="equality").step(Motion(torque=0.0, a_x=0.6, a_y=0.5)).drive == (0.0,) * 4


def test_a_car_that_slows_down_has_all_torque_on_the_rear_axle():
    """Zhileykin: phi = pi, j_y = 0, j_x <= 0, whatever the driver does.

    Eq 5 as printed would give a half.
    """
    assert front(made().step(Motion(torque=400.0, a_x=-2.0)).drive) == 0.0
    assert front(made(first_branch="rear").step(Motion(torque=400.0, a_x=-2.0)).drive) == 0.0
    assert front(made().step(Motion(torque=-400.0, a_x=2.0)).drive) == pytest.approx(-200.0)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(("angle", "straight"), [(0.19, 0.0), (0.21, 200.0), (1.0, 200.0)])
def test_the_rule_on_slowing_down_ends_beside_the_axis(angle, straight, side):
    """j_y = 0 is read as an angle of at most 0.2 rad.

    In a bend eq 5 as printed gives the most, a half.
    """
    motion = Motion(torque=400.0, a_x=-2.0 * math.cos(angle), a_y=side * 2.0 * math.sin(angle))
    assert front(made(first_branch="rear").step(motion).drive) == pytest.approx(straight)
    assert front(made(first_branch="rear", braking="deceleration").step(motion).drive) == 0.0


@pytest.mark.parametrize(
    "motion", [Motion(torque=-400.0, a_x=2.0), Motion(torque=100.0, brake=50.0, a_x=2.0)]
)
def test_braking_by_command_puts_all_torque_on_the_rear_axle(motion):
    assert made(braking="command").step(motion).drive == (
        0.0,
        0.0,
        motion.torque / 2,
        motion.torque / 2,
    )
    slows_down = Motion(torque=400.0, a_x=-2.0)
    assert front(
        made(braking="command", first_branch="rear").step(slows_down).drive
    ) == pytest.approx(200.0)


def test_the_slower_rear_wheel_gets_more_also_where_it_is_the_outer_one():
    """The right wheel is slower where the inner one spins: it gets (1 + q)/2, not (1 - q)/2."""
    motion = Motion(torque=1000.0, a_x=0.3, a_y=0.4, speeds=RIGHT_IS_SLOWER).steered(0.1)
    q = 2.7 * 0.1 * 0.5 / (2 * 1.55 * 0.5)
    assert made().step(motion).drive[2:] == pytest.approx((250 * (1 - q), 250 * (1 + q)), rel=1e-12)
    inner = made(rear_wheels="by_geometry").step(motion).drive
    assert inner[2:] == pytest.approx((250 * (1 + q), 250 * (1 - q)), rel=1e-12)


def test_rear_wheels_are_equal_until_one_is_the_slower_one_which_is_then_held():
    law, motion = made(), Motion(torque=1000.0, a_x=0.3, a_y=0.4).steered(0.1)
    first = law.step(motion).drive
    assert first.rear_left == first.rear_right
    slower = law.step(dataclasses.replace(motion, speeds=RIGHT_IS_SLOWER)).drive
    assert slower.rear_right > slower.rear_left
    within = RIGHT_IS_SLOWER._replace(rear_left=19.75)  # 0.05 rad/s slower, less than the deadband
    assert law.step(dataclasses.replace(motion, speeds=within)).drive == slower


def test_deadbands_hold_branch_and_direction():
    """Noise of slip angles within +-0.004 rad and of the acceleration changes no torque."""
    law = made()
    first = law.step(Motion(torque=1000.0, a_x=0.3))
    for sign in (1, -1, 1, -1):
        noisy = Motion(torque=1000.0, v=0.01, r=sign * 0.005, a_x=sign * 0.02, a_y=0.05)
        assert law.step(noisy) == first


@given(
    sequence=sequences,
    most=st.floats(0.0, 0.9),
    source=st.sampled_from(("truth", "estimated")),
    factor=st.sampled_from(("given", "inertia", "equality")),
    second_branch=st.sampled_from(("printed", "derived", "rear_share")),
)
def test_no_wheel_works_against_the_others_and_the_front_share_is_limited(
    sequence, most, **readings
):
    law = made(largest_front_share=most, **readings)
    for motion in sequence:
        drive = law.step(motion).drive
        assert all(torque * motion.torque >= 0.0 for torque in drive)
        assert sum(drive) == pytest.approx(motion.torque, rel=1e-12, abs=1e-300)
        assert (
            abs(drive.front_left + drive.front_right)
            <= most * abs(motion.torque) * (1 + 1e-14) + 1e-300
        )


def test_truth_needs_no_observer():
    """The speeds of the front wheels, which only the observer uses, change nothing."""
    motion = Motion(torque=1000.0, r=0.3, v=0.2, a_x=0.6, a_y=0.8).steered(0.1)
    spinning = dataclasses.replace(motion, speeds=motion.speeds._replace(front_left=90.0))
    assert made().step(motion) == made().step(spinning)


def test_a_car_without_four_driven_wheels_is_refused():
    line = "axle_redistribution needs front_left, front_right, rear_left and rear_right among the driven wheels"
    with pytest.raises(ParameterError, match=line):
        Differential(LAW, on(ZHILEYKIN, REAR))
