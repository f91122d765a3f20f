"""Ackermann-Jeantaud geometry of Shchur (2019) as printed, with the sign of delta in eq 11."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ev_sim.plant.kinematic import (
    course_offset,
    front_wheel_angles,
    path_curvature,
    wheel_speed_ratios,
)

WHEELBASE = 2.405
TRACK = 1.462
BEHIND = 0.45 * WHEELBASE  # the centre of mass in front of the rear axle

# Printed eqs 8 to 11 hold until the inner wheel stands across the car, at arctan(2 L/d) = 73 deg.
printed_angles = st.floats(1e-3, 1.25).flatmap(lambda angle: st.sampled_from((angle, -angle)))
angles = st.floats(-math.pi / 2, math.pi / 2)


def ratios_of(angle):
    return wheel_speed_ratios(angle, WHEELBASE, TRACK, TRACK, BEHIND)


@given(printed_angles)
def test_front_wheels_follow_the_printed_equations(angle):
    """Eqs 8 to 11 literally.

    1e-12 leaves room for cancellation in L/tan(delta) - d/2 near 73 deg.
    """
    right = math.atan(WHEELBASE / (WHEELBASE / math.tan(angle) + TRACK / 2))
    left = math.atan(WHEELBASE / (WHEELBASE / math.tan(angle) - TRACK / 2))
    radius = math.copysign(WHEELBASE * math.sqrt(math.tan(angle) ** -2 + 0.45**2), angle)
    assert front_wheel_angles(angle, WHEELBASE, TRACK) == pytest.approx((left, right), rel=1e-12)
    assert 1 / path_curvature(angle, WHEELBASE, BEHIND) == pytest.approx(radius, rel=1e-12)
    speeds = (WHEELBASE / math.sin(left) / radius, WHEELBASE / math.sin(right) / radius)
    assert ratios_of(angle)[:2] == pytest.approx(speeds, rel=1e-12)


@pytest.mark.parametrize(
    ("kilometres_per_hour", "degrees", "difference"),
    [(15, 30, 1.222), (30, 30, 2.444), (30, -30, -2.444)],
)
def test_difference_of_the_wheel_speeds_in_the_two_turns(kilometres_per_hour, degrees, difference):
    """Eq 12 with the printed parameters; half a unit of the last digit given."""
    left, right, _, _ = ratios_of(math.radians(degrees))
    assert kilometres_per_hour / 3.6 * (right - left) == pytest.approx(difference, abs=5e-4)


def test_all_wheels_run_alike_straight_ahead():
    assert ratios_of(0.0) == (1.0, 1.0, 1.0, 1.0)
    assert front_wheel_angles(0.0, WHEELBASE, TRACK) == (0.0, 0.0)
    assert path_curvature(0.0, WHEELBASE, BEHIND) == 0.0
    assert course_offset(0.0, WHEELBASE, BEHIND) == 0.0


@given(angles)
def test_a_right_turn_mirrors_a_left_turn_to_the_last_bit(angle):
    front_left, front_right, rear_left, rear_right = ratios_of(angle)
    assert ratios_of(-angle) == (front_right, front_left, rear_right, rear_left)
    left, right = front_wheel_angles(angle, WHEELBASE, TRACK)
    assert front_wheel_angles(-angle, WHEELBASE, TRACK) == (-right, -left)
    assert path_curvature(-angle, WHEELBASE, BEHIND) == -path_curvature(angle, WHEELBASE, BEHIND)
    assert course_offset(-angle, WHEELBASE, BEHIND) == -course_offset(angle, WHEELBASE, BEHIND)


@given(st.floats(-3.0, 3.0))
def test_every_wheel_moves_with_the_rigid_body_and_does_not_slip_sideways(angle):
    """Velocity of each wheel from that of the centre of mass and the yaw rate.

    1e-12 is rounding of values near 1.
    """
    curvature = path_curvature(angle, WHEELBASE, BEHIND)
    offset = course_offset(angle, WHEELBASE, BEHIND)
    left_angle, right_angle = front_wheel_angles(angle, WHEELBASE, TRACK)
    front = WHEELBASE - BEHIND
    wheels = (
        (front, TRACK / 2, left_angle),
        (front, -TRACK / 2, right_angle),
        (-BEHIND, TRACK / 2, 0.0),
        (-BEHIND, -TRACK / 2, 0.0),
    )
    for (x, y, wheel_angle), ratio in zip(wheels, ratios_of(angle), strict=True):
        velocity = (math.cos(offset) - curvature * y, math.sin(offset) + curvature * x)
        assert velocity == pytest.approx(
            (ratio * math.cos(wheel_angle), ratio * math.sin(wheel_angle)), abs=1e-12
        )


def test_inner_rear_wheel_rolls_backwards_about_a_centre_between_the_rear_wheels():
    rear_left, rear_right = ratios_of(math.radians(80))[2:]
    assert rear_left < 0.0 < rear_right


@pytest.mark.parametrize("angle", [math.pi / 2, math.atan(2 * WHEELBASE / TRACK)])
def test_nothing_jumps_where_tangent_or_arctangent_would(angle):
    """Column tests at rest pass 90 deg (fig 1a).

    The ratios move by less than 10 per radian there.
    """
    before, after = ratios_of(angle - 1e-6), ratios_of(angle + 1e-6)
    assert after == pytest.approx(before, abs=2e-5)
