"""Slip control by fuzzy rules (dissertation, the first section 1.4, which gives none of them)."""

from __future__ import annotations

import itertools
import math

import pytest
from helpers.launches import HELD_SURFACES, full_throttle, slip_of
from helpers.traction import PERIOD, Control, spinning_at
from hypothesis import given
from hypothesis import strategies as st

from ev_control.asr.slip_control import RULES, change_by_rules, degrees


def test_degrees_add_up_to_one():
    assert degrees(0.0) == (0.0, 1.0, 0.0)
    assert degrees(-0.25) == (0.25, 0.75, 0.0)
    assert degrees(9.0) == (0.0, 0.0, 1.0)


@given(value=st.floats(-1e6, 1e6))
def test_degrees_are_shares(value):
    """Equal to one rounding: of two numbers in 0..1 one is the other's complement."""
    found = degrees(value)
    assert min(found) >= 0.0
    assert math.fsum(found) == pytest.approx(1.0, abs=2.3e-16)


def test_at_the_middle_of_the_sets_one_rule_counts_alone():
    for (i, error), (j, rate) in itertools.product(enumerate((-1.0, 0.0, 1.0)), repeat=2):
        assert change_by_rules(error, rate) == RULES[i][j]


def test_between_the_sets_rules_count_by_their_degrees():
    """Half above the target and a quarter rising.

    0.5 (0.75 0.0 + 0.25 -0.4) + 0.5 (0.75 -0.4 + 0.25 -1.0).
    """
    assert change_by_rules(0.5, 0.25) == pytest.approx(0.5 * -0.1 + 0.5 * (-0.3 - 0.25), rel=1e-12)


def test_rules_take_torque_away_faster_than_they_give_it_back():
    assert -RULES[2][2] > RULES[0][0]
    assert all(a >= b for row in RULES for a, b in itertools.pairwise(row))


def test_first_step_by_hand():
    """Slip 0.18 is one width above 0.1, its rate is not known yet.

    0.4 of 10 1/s for 5 ms off the 1500 N m.
    """
    law = Control("fuzzy")
    law.step(spinning_at(10.0, 10.0))
    torque = law.step(spinning_at(10.0 / 0.82, 10.0)).front_left
    assert torque == pytest.approx(1500.0 * (1.0 - 0.4 * 10.0 * PERIOD), rel=1e-9)


def test_an_unfiltered_rate_is_that_of_the_last_period():
    """0.18 to 0.19 within 5 ms is 2 1/s, one width.

    It takes the whole of 10 1/s for 5 ms off what the first step left.
    """
    law = Control("fuzzy", filter_time=0.0)
    for slip in (0.0, 0.18, 0.19):
        torque = law.step(spinning_at(10.0 / (1.0 - slip), 10.0)).front_left
    assert torque == pytest.approx(
        1500.0 * (1.0 - 0.4 * 10.0 * PERIOD) * (1.0 - 10.0 * PERIOD), rel=1e-9
    )


@pytest.mark.parametrize("surface", HELD_SURFACES)
def test_slip_is_held_at_its_target(surface):
    """0.1 within 0.015 on the mean of the last 3 s; its noise at 2 m/s is 0.005."""
    assert slip_of(full_throttle("fuzzy", surface))[400:].mean() == pytest.approx(0.1, abs=0.015)
