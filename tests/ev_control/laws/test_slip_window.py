"""Traction control that holds the slip in a window (dissertation, eqs 1.5 and 1.6)."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from helpers.launches import full_throttle, slip_of
from helpers.traction import PERIOD, Control, spinning_at

from ev_control.asr.slip_window import SlipWindowParameters
from ev_msgs_py.refusal import ParameterError


def at_slip(slip: float) -> float:
    """Speed of a wheel [rad/s] that rolls at 10 rad/s with this slip [1]."""
    return 10.0 / (1.0 - slip)


def test_relations_of_parameters_are_checked():
    with pytest.raises(ParameterError, match=r"low is 0\.2, expected at most high, 0\.19"):
        SlipWindowParameters(low=0.2)


def test_first_limit_is_the_torque_at_which_the_slip_leaves_the_window():
    """Eq 1.6: the acting 1500 N m, and from then on 8000 N m/s less while the slip grows."""
    law = Control("slip_window")
    torques = [
        law.step(spinning_at(at_slip(slip), 10.0)).front_left
        for slip in (0.0, 0.18, 0.2, 0.21, 0.22)
    ]
    fall = 8000.0 * PERIOD
    assert torques == pytest.approx(
        [1500.0, 1500.0, 1500.0, 1500.0 - fall, 1500.0 - 2 * fall], rel=1e-12
    )


def test_limit_stays_inside_the_window_and_where_the_slip_returns():
    law = Control("slip_window", trend=PERIOD)  # half of the gap in each step
    for slip in (0.0, 0.25, 0.3, 0.35):
        limit = law.step(spinning_at(at_slip(slip), 10.0)).front_left
    # 0.2 is above the window but below the filtered slip before; 0.17 is inside.
    for slip in (0.2, 0.17, 0.17):
        assert law.step(spinning_at(at_slip(slip), 10.0)).front_left == limit < 1500.0


def test_limit_rises_below_the_window_until_it_is_the_request():
    """The limit rises by 2000 N m/s without rising slip: 40 N m are ten steps, less one."""
    law = Control("slip_window", trend=0.0)
    for slip in (0.0, 0.2):
        law.step(spinning_at(at_slip(slip), 10.0))
    state = law.law.state
    state[law.names.index("wheels.front_left.limit")] = 1460.0
    law.law.state = state
    torques = [law.step(spinning_at(at_slip(0.1), 10.0)).front_left for _ in range(4)]
    assert torques == pytest.approx([1470.0, 1480.0, 1490.0, 1500.0], rel=1e-12)
    assert law.limits()[0] == math.inf


@pytest.mark.parametrize(
    ("surface", "low", "high"), [("wet_asphalt_1", 0.11, 0.19), ("packed_snow_1", 0.09, 0.19)]
)
def test_slip_window_swings_below_its_window_behind_the_peak(surface, low, high):
    """0.15..0.19 lies behind the peaks (0.13 and 0.09).

    The wheel passes the window, and the mean is below it.
    """
    slip = slip_of(full_throttle("slip_window", surface))[400:]
    assert low < slip.mean() < 0.15
    assert np.quantile(slip, 0.95) == pytest.approx(high, abs=0.02)


def test_side_force_lowers_both_ends_of_the_window():
    """Front wheels at 0.096 rad of slip angle, 0.8 of the largest.

    0.6 of 0.15..0.19, so a slip of 0.14 is too much.
    """
    bend = {"side_force.correction": "ellipse", "side_force.observer.kinematic_share": 1.0}
    for changed, limited in ((bend, True), ({}, False)):
        law = Control("slip_window", **changed)
        for slip in (0.0, 0.13, 0.14, 0.145):
            angle = dataclasses.replace(spinning_at(at_slip(slip), 10.0), angle=0.096)
            torque = law.step(angle).front_left
        assert (torque < 1500.0) is limited
