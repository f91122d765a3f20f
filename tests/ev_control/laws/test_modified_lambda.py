"""The modified lambda controller (dissertation, the first section 1.4, figure 1.20)."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from helpers.launches import HELD_SURFACES, full_throttle, slip_of
from helpers.traction import INERTIA, PERIOD, Control, spinning_at

from ev_msgs_py.contract.wheels import Wheels

RADIUS = 0.32  # m


def test_first_step_by_hand():
    """M + J/T (w'* - w') t with w'* = (a_x/r - k w (S - 0.1))/(1 - S).

    The wheel turns at 12.5 rad/s over 10, S = 0.2, w' = 500.
    """
    law = Control("modified_lambda", filter_time=0.0, acceleration_time=0.5, rate=20.0)
    law.step(spinning_at(10.0, 10.0))
    m = dataclasses.replace(spinning_at(12.5, 10.0), torque=Wheels.front(1400.0, 1500.0))
    wanted = (1.0 / RADIUS - 20.0 * 12.5 * 0.1) / 0.8
    expected = 1400.0 + INERTIA / 0.5 * (wanted - 500.0) * PERIOD
    assert law.step(m).front_left == pytest.approx(expected, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("surface", HELD_SURFACES)
def test_slip_is_held_with_less_ripple_than_by_feedback_linearisation(surface):
    """The mean slip is the target within 0.015, and the torque's ripple is less.

    What the source says of it.
    """
    ripple = {}
    for law in ("modified_lambda", "feedback_linearisation"):
        channels = full_throttle(law, surface)
        torque = channels["torque_command.drive.front_left"][400:]
        smooth = np.convolve(torque, np.full(20, 0.05), "valid")  # over 0.1 s
        ripple[law] = float(np.std(torque[10 : 10 + len(smooth)] - smooth))
        assert slip_of(channels)[400:].mean() == pytest.approx(0.1, abs=0.015)
    assert ripple["modified_lambda"] < 0.6 * ripple["feedback_linearisation"]
