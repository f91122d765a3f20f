"""The motor that turns road wheels: limits, energy, what it holds."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ev_sim.steering.actuated import SteeringMotorParameters, SteeringMotorState, servo, turn

P = SteeringMotorParameters()
PERIOD = 0.01
ONE_STEP = 0.5e-3
ANGLES = st.floats(-0.2, 0.2)
MOMENTS = st.floats(-300.0, 300.0)


def test_it_rests_where_nothing_is_asked():
    s = SteeringMotorState()
    for _ in range(100):
        turn(P, servo(P, PERIOD), s, 0.0, 0.0)
    assert s == SteeringMotorState()


@pytest.mark.parametrize("moment", [0.0, 160.0, -160.0])
def test_it_holds_its_angle_against_the_road(moment):
    """160 N m are 5.3 kN of side force behind 3 cm of trail.

    The integral leaves no error, the motor carries M/i.
    """
    s = SteeringMotorState()
    for _ in range(300):
        turn(P, servo(P, PERIOD), s, 0.05, moment)
    assert s.angle == pytest.approx(0.05, abs=1e-6)
    assert s.torque == pytest.approx(-moment / P.gear_ratio, abs=1e-6)
    assert s.power == pytest.approx(
        P.copper_loss * (moment / P.gear_ratio) ** 2, rel=1e-3, abs=1e-6
    )


def test_it_gets_there_as_fast_as_it_may():
    """0.08 rad at 0.5 rad/s are 160 ms; 1/k_p = 33 ms and the start of the masses come on top."""
    s, time = SteeringMotorState(), 0.0
    while s.angle < 0.95 * 0.08:
        turn(P, servo(P, PERIOD), s, 0.08, 0.0)
        time += PERIOD
    assert 0.16 < time < 0.16 + 3 / P.position_gain


@given(st.lists(st.tuples(ANGLES, MOMENTS), min_size=1, max_size=40))
def test_limits_hold_whatever_is_asked_and_both_sides_are_alike(commands):
    """Peak torque and angle exactly.

    The rate is a set-point, which the road may pass by a little.
    """
    s, mirrored, c = SteeringMotorState(), SteeringMotorState(), servo(P, PERIOD)
    for wanted, moment in commands:
        turn(P, c, s, wanted, moment)
        turn(P, c, mirrored, -wanted, -moment)
        assert abs(s.angle) <= P.max_angle
        assert abs(s.torque) <= P.peak_torque
        assert (mirrored.angle, mirrored.rate, mirrored.torque, mirrored.power) == (
            -s.angle,
            -s.rate,
            -s.torque,
            s.power,
        )


@given(
    st.lists(st.tuples(st.floats(-0.05, 0.05), st.floats(-150.0, 150.0)), min_size=1, max_size=100)
)
def test_energy_closes(commands):
    """Supply = copper + friction + kinetic - work of the road, exactly for the step's rule."""
    s, c = SteeringMotorState(), servo(P, ONE_STEP)
    taken = losses = given_by_road = 0.0
    for wanted, moment in commands:
        before = s.rate
        turn(P, c, s, wanted, moment)
        mean = 0.5 * (before + s.rate)
        taken += c.h * s.power
        losses += c.h * (P.copper_loss * s.torque**2 + P.damping * s.rate * mean)
        given_by_road += c.h * moment * mean
    kinetic = 0.5 * c.inertia * s.rate**2
    assert taken == pytest.approx(losses + kinetic - given_by_road, rel=1e-9, abs=1e-9)


def test_power_is_limited():
    """500 W at 600 rad/s of the shaft leave 0.83 of 3 N m.

    In a step of 0.5 ms the speed gains less than 24 rad/s.
    """
    quick = SteeringMotorParameters(
        max_rate=100.0, position_gain=1000.0, max_angle=1.0, damping=0.0
    )
    s, c, most = SteeringMotorState(), servo(quick, ONE_STEP), 0.0
    for _ in range(1000):
        turn(quick, c, s, 1.0, 0.0)
        most = max(most, s.torque * quick.gear_ratio * s.rate)
    assert quick.peak_power * 0.99 < most < quick.peak_power * 1.15
