"""Target slip ratios of the rear wheels; computed by hand."""

from __future__ import annotations

import dataclasses

import pytest
from helpers.differentials import FRONT, GE_NI, Differential, Motion, on, sequences
from hypothesis import given
from hypothesis import strategies as st

from ev_msgs_py.contract.wheels import NO_WHEELS, WHEEL_NAMES, Wheels
from ev_msgs_py.refusal import ParameterError

LAW = "slip_target"
OUTER_TARGET = 0.19 - 0.11 * (0.1 - 0.03 * 5.0 / 1.72)  # 0.18859


def made(**changed) -> Differential:
    return Differential(LAW, GE_NI, **changed)


def left_turn(slip_left: float, slip_right: float) -> Motion:
    """Speed 5 m/s, delta = 0.03 rad, r = 0.1 rad/s.

    Rear wheels V = 5 -+ 0.1 * 0.56 m/s at the given slip ratios.
    """
    speeds = Wheels.rear(4.944 / (1 - slip_left) / 0.32, 5.056 / (1 - slip_right) / 0.32)
    return Motion(torque=2400.0, r=0.1, speeds=speeds).steered(0.03)


@pytest.mark.parametrize(
    ("reading", "after_one", "after_two"),
    [("rate", 0.01, 0.02), ("offset", 1, 1), ("increment", 1, 2)],
)
def test_readings_of_the_switching_control(reading, after_one, after_two):
    """Wheels far below their targets gain 50 and 100 N m (inner, outer) times the step."""
    law, motion = made(reading=reading), left_turn(0.05, 0.05)
    for factor in (after_one, after_two):
        drive = law.step(motion).drive
        assert drive[2:] == pytest.approx((1200 + 50 * factor, 1200 + 100 * factor), rel=1e-12)


def test_boundary_layer_is_linear_in_the_slip_error():
    """Errors of 0.4 and -0.25 layers give 0.4 and -0.25 of the gains.

    Without the layer the full gains.
    """
    motion = left_turn(0.19 - 0.4e-3, OUTER_TARGET + 0.25e-3)
    inside = made(reading="offset").step(motion).drive
    assert inside[2:] == pytest.approx((1220.0, 1175.0), abs=1e-8)
    switched = made(reading="offset", boundary_layer=False).step(motion).drive
    assert switched[2:] == pytest.approx((1250.0, 1100.0), rel=1e-12)


def test_both_wheels_are_inner_ones_straight_ahead():
    """Neither steered nor yawing: gain 50 N m and target 0.19 for both."""
    speeds = Wheels.rear(*(5.0 / (1 - 0.19 + 0.4e-3) / 0.32,) * 2)
    drive = made(reading="offset").step(Motion(torque=2400.0, speeds=speeds)).drive
    assert drive[2:] == pytest.approx((1220.0, 1220.0), abs=1e-8)


def test_a_car_that_yaws_without_steering_turns():
    """The outer wheel gets its own gain.

    1 + 100 N m on the right in a left turn by the yaw rate alone.
    """
    motion = dataclasses.replace(left_turn(0.05, 0.05).steered(0.0), torque=2400.0)
    assert made(reading="offset").step(motion).drive[2:] == pytest.approx(
        (1250.0, 1300.0), rel=1e-12
    )


def test_estimated_speed_comes_from_the_front_wheels():
    """Free front wheels that roll at 5 m/s straight ahead do what the true 5 m/s does.

    A wrong one does not.
    """
    speeds = Wheels(5.0 / 0.32, 5.0 / 0.32, *(5.0 / (1 - 0.19 + 0.4e-3) / 0.32,) * 2)
    law = made(reading="offset", source="estimated")
    drive = law.step(Motion(torque=2400.0, speeds=speeds, u=77.0)).drive
    assert drive[2:] == pytest.approx((1220.0, 1220.0), abs=1e-8)


def test_pedal_release_forgets_the_correction():
    law = made(reading="increment")
    law.step(left_turn(0.05, 0.05))
    assert law.state["left"] > 0.0
    assert law.step(dataclasses.replace(left_turn(0.05, 0.05), torque=0.0)).drive == NO_WHEELS
    assert law.state["left"] == law.state["right"] == 0.0


@given(
    sequence=sequences,
    reading=st.sampled_from(("rate", "offset", "increment")),
    layer=st.booleans(),
)
def test_torques_stay_within_their_limit(sequence, reading, layer):
    """Each torque is within half of its equal share of it (largest_correction 0.5).

    No pedal, no correction.
    """
    law = made(reading=reading, boundary_layer=layer)
    for motion in sequence:
        drive, share = law.step(motion).drive, motion.torque / 2
        assert drive[:2] == (0.0, 0.0)
        if motion.torque <= 0.0 or motion.brake > 0.0:
            assert drive[2:] == (share, share)
        else:
            assert all(
                0.5 * share * (1 - 1e-12) <= torque <= 1.5 * share * (1 + 1e-12)
                for torque in drive[2:]
            )


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
    with pytest.raises(ParameterError, match=f"slip_target needs {needed}"):
        Differential(LAW, on(GE_NI, driven))
