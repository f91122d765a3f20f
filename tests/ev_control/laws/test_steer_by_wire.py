"""The servo that turns the road wheels by the drives alone."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.signal
from helpers.differentials import REAR, SHCHUR, Differential, motions, on
from helpers.steering_loop import LEVER, PERIOD, Column, K, difference, drive, law
from hypothesis import given
from hypothesis import strategies as st

from ev_core.lockstep.finding import find_method
from ev_msgs_py.refusal import ParameterError


def held(angle: float, **changed: float) -> Column:
    return Column("by_wire", held=16 * angle, **changed)


def test_servo_is_the_second_order_system_of_its_parameters():
    """w_0^2/(s^2 + 2 D w_0 s + w_0^2) by scipy: the zero cancels the integral's pole.

    The torque is held, half a period late on average, so the damping is off by about w_0 T/2 = 0.4
    %, and the angle by less than 0.5 % of its step.
    """
    differential = law("steer_by_wire")
    angle, _ = drive(held(0.5), differential, hand_torque=0.0, duration=3.0)
    p = differential.parameters
    w_0 = p.natural_frequency
    servo = scipy.signal.TransferFunction([w_0**2], [1.0, 2 * p.damping_ratio * w_0, w_0**2])
    _, exact = scipy.signal.step(servo, T=np.arange(angle.size) * PERIOD)
    assert abs(angle - 0.5 * exact).max() < 0.005 * 0.5


@pytest.mark.parametrize(
    "changed", [{}, {"stiffness": 130.0}, {"dry_friction": 5.0}, {"inertia": 4.0}]
)
def test_servo_needs_no_exact_knowledge(changed):
    """Twice the stiffness, friction, more inertia and a torque of 5 N m unknown to the law.

    The angle is met.

    Ten seconds are 20 time constants of the integral action (e^-20); with dry friction the last bit
    sticks, and it takes the integral longer: 0.1 %.
    """
    angle, _ = drive(
        held(0.5, **changed), law("steer_by_wire"), hand_torque=0.0, duration=10.0, disturbance=5.0
    )
    assert angle[-1] == pytest.approx(0.5, rel=1e-3)


def test_servo_recovers_from_its_limit():
    """25 N m hold 0.8 rad only to 62 N m/65 = 0.96 rad.

    A steering wheel at 1.5 rad drives it into the limit for 20 s.

    Turned back to 0.5 rad, the wheels get there as fast as from rest: no wound-up integral. 5 %:
    the way is longer.
    """
    differential, column = law("steer_by_wire", max_torque_difference=25.0), held(1.5)
    angle, torque = drive(column, differential, hand_torque=0.0, duration=20.0)
    assert abs(torque).max() <= 25.0 * (1 + 1e-15)
    assert angle[-1] == pytest.approx(LEVER * 25.0 / K, rel=1e-3)
    column.hold(16 * 0.5)
    angle, _ = drive(column, differential, hand_torque=0.0, duration=2.0)
    assert abs(angle[-1] - 0.5) < 0.05 * 0.5


@given(sequence=st.lists(motions, min_size=1, max_size=8), most=st.floats(0.0, 1000.0))
def test_difference_stays_within_its_limit(sequence, most):
    """Equal to the rounding of limit over lever times lever, and of torques of up to 2000 N m."""
    differential = law("steer_by_wire", max_torque_difference=most)
    for motion in sequence:
        assert abs(difference(differential.step(motion))) <= most * (1 + 1e-14) + 1e-12


@pytest.mark.parametrize("driven", [REAR, ("front_left",), ()])
def test_a_car_without_two_front_drives_is_refused(driven):
    with pytest.raises(
        ParameterError,
        match="steer_by_wire needs front_left and front_right among the driven wheels",
    ):
        Differential("steer_by_wire", on(SHCHUR, driven))


def test_hands_turn_nothing_else():
    assert find_method("electronic_differential", "steer_by_wire").requires == {
        "steering_column": "by_wire"
    }
