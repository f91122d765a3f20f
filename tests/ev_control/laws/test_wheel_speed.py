"""Rear wheels on the speeds of Ackermann's geometry; computed by hand."""

from __future__ import annotations

import dataclasses
import math

import pytest
from helpers.differentials import FRONT, GE_NI, Differential, Motion, on, sequences
from hypothesis import given
from hypothesis import strategies as st

from ev_msgs_py.contract.wheels import NO_WHEELS, WHEEL_NAMES, Wheels
from ev_msgs_py.refusal import ParameterError
from ev_papers.ge_ni2005.wheel_speeds import cases, measure
from ev_study.studies.study import drive_case

LAW = "wheel_speed"
TURNED = 1.12 * math.tan(0.03) / (2 * 1.72)  # k of a left turn by 0.03 rad


def made(**changed) -> Differential:
    return Differential(LAW, GE_NI, **changed)


def rolling(
    left: float, right: float, angle: float = 0.03, torque: float = 2400.0, **changed
) -> Motion:
    """Rear wheels at these speeds [rad/s] with 1200 N m on each."""
    motion = Motion(torque=torque, speeds=Wheels.rear(left, right)).steered(angle)
    return dataclasses.replace(motion, **changed)


def test_wheels_that_roll_about_the_centre_keep_equal_torques():
    drive = made().step(rolling(17.0 * (1 - TURNED), 17.0 * (1 + TURNED))).drive
    assert drive[2:] == pytest.approx((1200.0, 1200.0), rel=1e-12)


def test_the_error_of_the_speed_difference_by_proportion_and_integral():
    """Equal speeds of 17 rad/s lack 17 k = 0.166 rad/s on each wheel.

    500 of it at once, 2500 * 0.01 in each period.
    """
    law, error = made(), 17.0 * TURNED
    for periods in (1, 2):
        change = 500.0 * error + 25.0 * periods * error
        drive = law.step(rolling(17.0, 17.0)).drive
        assert drive[2:] == pytest.approx((1200.0 - change, 1200.0 + change), rel=1e-12)


def test_both_speeds_hold_their_mean_as_it_was():
    """The mean falls from 17 to 16.9 rad/s: 500 * 0.1 + 25 * 0.1 N m more on both.

    By torque it is free to fall.
    """
    for mean, more in (("speed", 52.5), ("torque", 0.0)):
        law = made(mean=mean)
        law.step(rolling(17.0, 17.0, 0.0))
        assert law.step(rolling(16.9, 16.9, 0.0)).drive[2:] == pytest.approx(
            (1200.0 + more,) * 2, rel=1e-9
        )


def test_in_reverse_the_outer_wheel_is_the_faster_one_too():
    """Backwards with the wheels to the left the right wheel has the longer way.

    It gets more of the negative torque.
    """
    change = 525.0 * 17.0 * TURNED
    drive = made().step(rolling(-17.0, -17.0, torque=-2400.0)).drive
    assert drive[2:] == pytest.approx((-1200.0 + change, -1200.0 - change), rel=1e-12)


def test_a_car_that_starts_has_equal_torques_until_a_wheel_turns():
    assert made().step(rolling(0.0, 0.0, 0.5)).drive == (0.0, 0.0, 1200.0, 1200.0)


def test_a_slipping_wheel_is_held_by_the_other_one():
    """Left on ice at 20 rad/s, right at 15: half of the share goes over, which is the limit."""
    assert made().step(rolling(20.0, 15.0, 0.0)).drive[2:] == pytest.approx(
        (600.0, 1800.0), rel=1e-12
    )


def test_pedal_and_brake_forget_what_was_held():
    for end in ({"torque": 0.0}, {"brake": 500.0}):
        law = made(mean="speed")
        law.step(rolling(17.0, 16.0))
        assert law.state["difference"] != 0.0
        request = law.step(rolling(17.0, 16.0, **end))
        assert request.drive == (
            (0.0,) * 4 if end == {"torque": 0.0} else (0.0, 0.0, 1200.0, 1200.0)
        )
        assert all(value == 0.0 for name, value in law.state.items() if name != "held")


@given(sequence=sequences, mean=st.sampled_from(("torque", "speed")))
def test_torques_stay_within_their_limits(sequence, mean):
    """Half of the share each for the difference and for the mean; no pedal, no torque."""
    law = made(mean=mean)
    for motion in sequence:
        drive, share = law.step(motion).drive, motion.torque / 2
        most = (0.5 if mean == "torque" else 1.0) * abs(share) * (1 + 1e-12)
        assert drive[:2] == NO_WHEELS[:2]
        assert all(abs(torque - share) <= most for torque in drive[2:])


@pytest.mark.parametrize(
    ("driven", "needed"),
    [
        (
            FRONT,
            "rear_left and rear_right among the driven wheels, vehicle ge_ni2005 drives front_left, front_right",
        ),
        (
            WHEEL_NAMES,
            "rear_left and rear_right as the only driven wheels, vehicle ge_ni2005 drives front_left",
        ),
    ],
)
def test_other_layouts_are_refused(driven, needed):
    with pytest.raises(ParameterError, match=f"{LAW} needs {needed}"):
        Differential(LAW, on(GE_NI, driven))


@pytest.mark.slow
def test_what_ge_and_ni_say_against_wheel_speeds_holds_in_part():
    """Slips come closer (0.4 of equal torques'), a radius 1 % wrong turns the car straight ahead.

    At 1600 N m equal torques spin the inner wheel (slip 0.9), wheel speeds none; at 1700 N m they
    spin both.
    """
    names = (
        *("turn: equal torques", "turn: speed difference"),
        *(
            f"straight, left wheel 1 % smaller: {law}"
            for law in ("equal torques", "speed difference")
        ),
        *(f"turn, 1600 N m on each wheel: {law}" for law in ("equal torques", "speed difference")),
        "turn, 1700 N m on each wheel: speed difference",
    )
    found = {
        case.name: drive_case(case, measure).measured for case in cases(None) if case.name in names
    }
    equal, speeds, off_equal, off_speeds, near_equal, near_speeds, beyond = (
        found[name] for name in names
    )
    assert abs(speeds["slip_left"] - speeds["slip_right"]) < 0.5 * abs(
        equal["slip_left"] - equal["slip_right"]
    )
    assert speeds["yaw_rate"] > 1.2 * equal["yaw_rate"]
    assert off_speeds["yaw_rate"] > 5 * abs(off_equal["yaw_rate"])
    assert near_equal["peak_slip"] > 0.8 > 0.2 > near_speeds["peak_slip"]
    assert min(beyond["slip_left"], beyond["slip_right"]) > 0.8
