"""The least-squares traction control exactly as the dissertation prints it (eqs 2.34 to 2.36)."""

from __future__ import annotations

import dataclasses
import math

import pytest
from helpers.launches import SURFACE_NAMES, full_throttle, slip_of
from helpers.traction import Control, Measured, spinning_at

from ev_msgs_py.contract.wheels import Wheels

SLOPE = -4.0  # A; with B = 2 the curve A x + B sqrt(x) peaks at x = 1/16


def on_the_curve(slip: float, asked: float) -> Measured:
    """Front wheels with a slip over 10 rad/s, and the curve's torque in parts of 1850 N m."""
    torque = 1850.0 * (SLOPE * slip + 2.0 * math.sqrt(slip))
    wheel = 10.0 / (1.0 - slip)
    return dataclasses.replace(
        spinning_at(wheel, wheel),
        drive=Wheels.front(asked, asked),
        torque=Wheels.front(torque, torque),
    )


def test_the_torque_of_the_step_before_the_peak_was_passed_is_held():
    """25 samples from slip 0.02 to 0.2, past the peak at 0.0625; the request rises by 10 N m each.

    The window fills in step 25, and the fitted curve, which is the true one, falls there: the
    torque of step 24 stays.
    """
    law = Control("least_squares_literal")
    asked = [1000.0 + 10.0 * n for n in range(25)]
    torques = [law.step(on_the_curve(0.02 + 0.18 * n / 24, asked[n])).front_left for n in range(25)]
    assert torques[:24] == asked[:24]
    assert torques[24] == asked[23]


def test_nothing_is_held_while_the_curve_rises():
    """Up to a slip of 0.06, short of the peak at 0.0625."""
    law = Control("least_squares_literal")
    for n in range(25):
        asked = 1000.0 + 10.0 * n
        assert law.step(on_the_curve(0.02 + 0.04 * n / 24, asked)).front_left == asked
    assert law.of_wheel()["fit.taken"] == 25.0


@pytest.mark.parametrize(("speed", "rolling"), [(0.0, 0.0), (9.0, 10.0)])
def test_what_the_source_does_not_define_is_no_sample(speed, rolling):
    """Rest is 0/0, and a wheel slower than rolling gives a slip without a root."""
    law = Control("least_squares_literal")
    wheels = Wheels(speed, speed, rolling, rolling)
    law.step(dataclasses.replace(spinning_at(speed, speed), speed=wheels))
    assert law.of_wheel()["fit.taken"] == 0.0


@pytest.mark.parametrize("surface", SURFACE_NAMES)
def test_the_literal_form_does_nothing_useful(surface):
    """Its mean slip is that of no control within 5 %."""
    mean, off = (
        slip_of(full_throttle(law, surface))[200:].mean()
        for law in ("least_squares_literal", "off")
    )
    assert mean == pytest.approx(off, rel=0.05)
