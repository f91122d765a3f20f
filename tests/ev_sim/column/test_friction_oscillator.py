"""Inertia, spring, damper, dry friction with a real stick phase, end stops."""

from __future__ import annotations

import math

import numpy as np
import pytest
import scipy.linalg
from column.columns import B, J, K
from hypothesis import given, settings
from hypothesis import strategies as st

from ev_core.compiled.loop import compiled
from ev_sim.steering.friction_oscillator import oscillated, oscillator

FAR = 1e6  # an end stop that is never reached [rad]

advance = compiled(oscillated)


def energy(angle: float, rate: float) -> float:
    return J * rate**2 / 2 + K * angle**2 / 2


@given(
    j=st.floats(0.01, 100.0),
    b=st.floats(0.0, 1000.0),
    k=st.floats(0.01, 1000.0),
    angle=st.floats(-1.0, 1.0),
    rate=st.floats(-10.0, 10.0),
    torque=st.floats(-100.0, 100.0),
)
@settings(max_examples=200)
def test_motion_without_friction_is_the_matrix_exponential(j, b, k, angle, rate, torque):
    """Any damping, against scipy's expm.

    It loses digits in proportion to the norm of the matrix, hence 1e-8.
    """
    period = 0.01
    system = np.array([[0.0, 1.0, 0.0], [-k / j, -b / j, 1 / j], [0.0, 0.0, 0.0]])
    expected = scipy.linalg.expm(system * period) @ [angle, rate, torque]
    got = advance(oscillator(j, b, k, 0.0, FAR, period), angle, rate, torque)
    assert got == pytest.approx(expected[:2], rel=1e-8, abs=1e-8)


def test_critical_damping_is_no_special_case():
    """J = 1, b = 2, k = 1 from x = 1 at rest: x = (1 + t) e^-t; the tolerance is rounding."""
    motion, angle, rate = oscillator(1.0, 2.0, 1.0, 0.0, FAR, 0.1), 1.0, 0.0
    for _ in range(20):
        angle, rate = advance(motion, angle, rate, 0.0)
    assert (angle, rate) == pytest.approx((3 * math.exp(-2.0), -2 * math.exp(-2.0)), rel=1e-12)


@pytest.mark.parametrize("period", [0.001, 0.0123, 0.3])
def test_dry_friction_takes_the_same_angle_of_every_half_oscillation(period):
    """Coulomb's oscillator.

    Turning points 0.95, -0.75, 0.55, -0.35, 0.15, 0.05 with M_c/k = 0.1 rad, then it sticks.

    Every half oscillation takes pi sqrt(J/k). Exact at any period up to rounding.
    """
    motion, half = oscillator(J, 0.0, K, 6.5, FAR, period), math.pi * math.sqrt(J / K)
    angle, rate, step = 0.95, 0.0, 0
    while (step + 1) * period < 5 * half:
        angle, rate = advance(motion, angle, rate, 0.0)
        step += 1
        halves, phase = divmod(step * period, half)
        centre = 0.1 * (-1) ** halves
        start = (-1) ** halves * (0.95 - 0.2 * halves)
        assert angle == pytest.approx(
            centre + (start - centre) * math.cos(math.pi * phase / half), abs=1e-12
        )
    angle, rate = advance(motion, angle, rate, 0.0)
    assert (angle, rate) == (pytest.approx(0.05, abs=1e-12), 0.0)


@given(direction=st.sampled_from([-1.0, 1.0]), friction=st.floats(0.1, 100.0))
def test_breakaway_is_at_the_dry_friction(direction, friction):
    """Nothing moves at exactly M_c.

    A part in 10^9 more moves the wheels that way, and only that far: (T - M_c)/k.
    """
    motion = oscillator(J, B, K, friction, FAR, 0.01)
    assert advance(motion, 0.0, 0.0, direction * friction) == (0.0, 0.0)
    torque, angle, rate = friction * (1 + 1e-9), 0.0, 0.0
    for step in range(1000):
        angle, rate = advance(motion, angle, rate, direction * torque)
        assert direction * angle > 0.0, step
        assert direction * angle <= 2 * (torque - friction) / K


@given(
    b=st.floats(0.0, 100.0),
    k=st.floats(0.1, 1000.0),
    friction=st.floats(0.001, 10.0),
    angle=st.floats(-0.5, 0.5),
    direction=st.sampled_from([-1.0, 1.0]),
    more=st.integers(0, 3),
)
@settings(max_examples=500)
def test_a_torque_that_is_more_than_the_friction_by_rounding_alone_comes_to_an_end(
    b, k, friction, angle, direction, more
):
    """The equilibrium may be where the motion begins, or a rounding behind it.

    That is rest, and no phase without end.

    The angle then stays, to 8 roundings of the numbers of which it is the difference.
    """
    torque = k * angle + direction * friction
    for _ in range(more):
        torque = math.nextafter(torque, direction * math.inf)
    next_angle, next_rate = oscillated(oscillator(J, b, k, friction, FAR, 0.01), angle, 0.0, torque)
    rounding = 8 * math.ulp(max(abs(torque), friction, k * abs(angle))) / k
    assert next_angle == pytest.approx(angle, abs=rounding + 8 * math.ulp(angle))
    assert abs(next_rate) <= 1e-9


def test_motion_keeps_dry_friction_against_it():
    """A steady pull from rest settles short by M_c/k: overdamped, so it never turns back.

    10 time constants of 0.12 s.

    The settled angle is approached by e^-10 at least.
    """
    motion, angle, rate = oscillator(0.1, 8.0, K, 6.5, FAR, 0.01), 0.0, 0.0
    for _ in range(300):
        angle, rate = advance(motion, angle, rate, 65.0)
    assert angle == pytest.approx(0.9, rel=1e-4)


states = {
    "angle": st.floats(-1.0, 1.0),
    "rate": st.floats(-20.0, 20.0),
    "friction": st.sampled_from([0.0, 0.5, 6.5, 50.0]),
    "damping": st.sampled_from([0.0, 1.0, 7.5, 60.0]),
    "stop": st.sampled_from([1.0, 1.5, FAR]),
    "period": st.sampled_from([0.001, 0.01, 0.1, 1.0]),
}


@given(**states)
def test_energy_never_grows_without_torque(angle, rate, friction, damping, stop, period):
    """Friction and stops only take energy.

    One part in 10^12 is the rounding of a step; 1e-17 J that of a tiny angle beside M_c/k.
    """
    motion = oscillator(J, damping, K, friction, stop, period)
    for _ in range(100):
        before = energy(angle, rate)
        angle, rate = advance(motion, angle, rate, 0.0)
        assert energy(angle, rate) <= before * (1 + 1e-12) + 1e-17


@given(torques=st.lists(st.floats(-300.0, 300.0), min_size=1, max_size=20), **states)
def test_mirror_and_stops(torques, angle, rate, friction, damping, stop, period):
    """Left and right mirror to the bit, and no stop is ever passed, under any torques."""
    motion = oscillator(J, damping, K, friction, stop, period)
    mirrored = (-angle, -rate)
    for torque in torques:
        angle, rate = advance(motion, angle, rate, torque)
        mirrored = advance(motion, *mirrored, -torque)
        assert mirrored == (-angle, -rate)
        assert abs(angle) <= stop


@given(torque=st.floats(-200.0, 200.0), **states)
def test_motion_does_not_depend_on_the_period(torque, angle, rate, friction, damping, stop, period):
    """Ten steps of a tenth end where one step ends, reversals, sticking and impacts included.

    1e-6: an impact or a reversal at low speed magnifies rounding (its instant shifts by the root of
    it).
    """
    whole = advance(oscillator(J, damping, K, friction, stop, period), angle, rate, torque)
    tenth = oscillator(J, damping, K, friction, stop, period / 10)
    for _ in range(10):
        angle, rate = advance(tenth, angle, rate, torque)
    assert (angle, rate) == pytest.approx(whole, abs=1e-6)


def test_impact_happens_in_mid_step():
    """Undamped under 0.8 k.

    x = 0.8 (1 - cos w t) meets the stop at 1 rad, loses its speed, swings around 0.8 rad.

    Rounding only: the instant of the impact is known to the last bit.
    """
    w = math.sqrt(K / J)
    impact = math.acos(-0.25) / w
    period = 1.2 * impact
    angle, _ = advance(oscillator(J, 0.0, K, 0.0, 1.0, period), 0.0, 0.0, 0.8 * K)
    assert angle == pytest.approx(0.8 + 0.2 * math.cos(w * (period - impact)), abs=1e-12)
