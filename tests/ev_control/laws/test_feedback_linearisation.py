"""Slip control by feedback linearisation (dissertation, the first section 1.4)."""

from __future__ import annotations

import dataclasses
import math

import pytest
from helpers.launches import HELD_SURFACES, full_throttle, slip_of
from helpers.traction import INERTIA, PERIOD, SPINNING, Control, spinning_at

from ev_msgs_py.contract.wheels import Wheels

RADIUS = 0.32  # m


def test_first_step_by_hand():
    """M_road = M - J w', S = 0.2, w = 12.5, w' = 500: J/(1 - S) (a_x/r - 25 w (S - 0.1))."""
    law = Control("feedback_linearisation", road_filter=0.0)
    law.step(spinning_at(10.0, 10.0))
    torque = law.step(
        dataclasses.replace(spinning_at(12.5, 10.0), torque=Wheels.front(3000.0, 1500.0))
    ).front_left
    road = 3000.0 - INERTIA * 500.0
    expected = road + INERTIA / 0.8 * (1.0 / RADIUS - 25.0 * 12.5 * 0.1)
    assert torque == pytest.approx(min(expected, 1500.0), rel=1e-12)
    assert law.of_wheel()["limit"] == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("rate", [10.0, 25.0])
@pytest.mark.parametrize("road", [300.0, 900.0])
def test_slip_error_decays_exponentially_whatever_the_road_takes(rate, road):
    """J w' = M - M_road with the commanded torque.

    S - S* = 0.05 exp(-k t), within 5 % of its start in steps of 5 ms.

    The wheel starts at a slip of 0.15 over a car that drives at 8 m/s and gains 2 m/s^2. In the
    first step, which only tells its speed, it gets the torque that keeps its slip.
    """
    law = Control("feedback_linearisation", road_filter=0.0, rate=rate)
    speed, wheel, acting = 8.0, 8.0 / RADIUS / 0.85, 0.0
    for n in range(60):
        rolling = speed / RADIUS
        error = 1.0 - rolling / wheel - 0.1
        assert error == pytest.approx(
            0.05 * math.exp(-rate * PERIOD * max(n - 1, 0)), abs=0.05 * 0.05
        )
        m = dataclasses.replace(
            SPINNING,
            speed=Wheels(wheel, rolling, rolling, rolling),
            torque=Wheels.front(acting, road),
            a_x=2.0,
        )
        acting = law.step(m).front_left
        if n == 0:
            acting = road + INERTIA * 2.0 / RADIUS / 0.85
        wheel += (acting - road) / INERTIA * PERIOD
        speed += 2.0 * PERIOD


@pytest.mark.parametrize("surface", HELD_SURFACES)
def test_slip_is_held_at_its_target(surface):
    """0.1 within 0.015 on the mean of the last 3 s; its noise at 2 m/s is 0.005."""
    slip = slip_of(full_throttle("feedback_linearisation", surface))[400:]
    assert slip.mean() == pytest.approx(0.1, abs=0.015)
