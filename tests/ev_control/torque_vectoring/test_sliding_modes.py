"""The suboptimal sliding mode on the double integrator of its source: s'' = v + f, |f| < F."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from helpers.differentials import ZHILEYKIN

from ev_control.torque_vectoring.integral import MomentIntegral
from ev_control.torque_vectoring.sliding_modes import (
    SuboptimalParameters,
    SuboptimalState,
    suboptimal_moment,
)

CAR = replace(ZHILEYKIN, yaw_inertia=2500.0)
P = SuboptimalParameters(rate=12.0, layer=1e-6)  # as in the source, without a layer


def errors(disturbance: float, period: float, end: float, side: float = 1.0) -> list[float]:
    """Error from 0.3 rad/s on, growing by 0.5 rad/s^2, under a square wave [rad/s^3]."""
    state, integral = SuboptimalState(), MomentIntegral()
    s, rate, before, found = side * 0.3, side * 0.5, 0.0, []
    for n in range(round(end / period)):
        moment = suboptimal_moment(P, CAR, state, integral, period, s)
        pushed = (moment - before) / period / CAR.yaw_inertia
        pushed += side * math.copysign(disturbance, math.sin(math.pi * n * period + 0.1))
        s, rate, before = (
            s + period * rate + 0.5 * period * period * pushed,
            rate + period * pushed,
            moment,
        )
        found.append(s)
    return found


@pytest.mark.parametrize("disturbance", [0.0, 2.0, 5.5])
def test_the_error_vanishes_in_finite_time_whatever_disturbs_it(disturbance: float):
    """F < V_M/2: it is on the surface within 2 s and stays there to the order of T^2.

    (V_M + F) T^2/2 is the way of a period; 20 (V_M + F) T^2 is allowed, a few periods until an
    extremum is seen.
    """
    for period in (1e-2, 1e-3):
        settled = errors(disturbance, period, 4.0)[round(2.0 / period) :]
        assert max(abs(s) for s in settled) < 20.0 * (P.rate + disturbance) * period * period


def test_a_disturbance_beyond_the_rate_is_not_held():
    """F > V_M, so that no sign of v turns s'' round: the error grows to more than it began with."""
    assert max(abs(s) for s in errors(13.0, 1e-3, 4.0)[2000:]) > 0.3


def test_within_the_layer_a_steady_disturbance_leaves_what_the_layer_says():
    """The rate at s = s_M, V_M (s - s_M/2)/layer is F: s = 2 F layer/V_M, 0.05 rad/s."""
    p = SuboptimalParameters(rate=12.0, layer=0.05)
    state, integral, s, rate, period = SuboptimalState(), MomentIntegral(), 0.1, 0.0, 1e-3
    for _ in range(4000):
        before = integral.moment
        pushed = (
            suboptimal_moment(p, CAR, state, integral, period, s) - before
        ) / period / CAR.yaw_inertia + 6.0
        s, rate = s + period * rate + 0.5 * period * period * pushed, rate + period * pushed
    assert s == pytest.approx(2.0 * 6.0 * 0.05 / 12.0, rel=0.05)


def test_a_mirrored_error_is_given_the_mirrored_moment_to_the_bit():
    assert errors(5.0, 1e-2, 2.0, side=-1.0) == [-s for s in errors(5.0, 1e-2, 2.0)]
