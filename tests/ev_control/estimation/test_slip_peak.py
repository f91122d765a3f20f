"""Passed peaks of the slip curve (dissertation, eqs 2.34 to 2.36)."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest
from helpers.traction import PERIOD, numbers_of

from ev_control.estimation.slip_peak import (
    SlipPeakParameters,
    SlipPeakState,
    peak_is_passed,
    watch_slip,
)
from ev_control.estimation.wheel_dynamics import start_again

PEAK = 1.0 / 16.0 - 1e-4  # of -4 x + 2 sqrt(x + 1e-4)


def passes(slips: list[float], noise: float = 1e-4, **changed) -> tuple[list[bool], SlipPeakState]:
    """Answer in each step of slips along the curve.

    The torque is that of the mean slip of the period.
    """
    p, s, hits_found = numbers_of(SlipPeakParameters(**changed)), SlipPeakState(), []
    for slip in slips:
        mean = max((slip + s.slip) / 2, 0.0)
        watch_slip(p, s, PERIOD, slip, -4.0 * mean + 2.0 * math.sqrt(mean + 1e-4))
        hits_found.append(peak_is_passed(p, s, noise))
    return hits_found, s


RISING = [0.002 * n for n in range(1, 61)]  # to 0.12, 0.05 within a window of 25


@pytest.mark.parametrize("hits", [1, 5, 12])
def test_peak_is_passed_after_as_many_steps_as_asked_for(hits):
    """The fit is exact, so the first hit is the first slip beyond the peak, step 32.

    Then that many in a row.
    """
    hits_found, s = passes(RISING, hits=hits)
    first = next(n for n, slip in enumerate(RISING) if slip > PEAK)
    assert hits_found.index(True) == first + hits - 1
    assert s.peak == pytest.approx(PEAK, rel=1e-9)


def test_a_hit_restarts_the_count():
    """Every fifth step behind the peak."""
    hits_found, _ = passes(RISING, hits=5)
    hits = [n for n, is_hit in enumerate(hits_found) if is_hit]
    assert [b - a for a, b in pairwise(hits)] == [5] * (len(hits) - 1)
    assert len(hits) >= 4


def test_scatter_that_noise_explains_is_no_reason():
    """0.05 within a window have the deviation 0.0144.

    A noise of a third of that, times 3, is no less.
    """
    hits_found, _ = passes(RISING, noise=0.0049)
    assert not any(hits_found)
    hits_found, _ = passes(RISING, noise=0.0045)
    assert any(hits_found)


def test_slip_below_the_least_one_is_no_reason():
    hits_found, _ = passes(RISING, least_slip=0.13)
    assert not any(hits_found)


def test_a_window_that_is_not_full_says_nothing():
    """2 s are 400 samples."""
    hits_found, _ = passes(RISING, window=2.0)
    assert not any(hits_found)


def test_slip_that_returns_below_the_mean_of_the_window_is_no_reason():
    """Up in 40 steps, down in 40.

    No hit on the way down below the mean of the window, though above the peak.
    """
    slips = [0.003 * n for n in range(1, 41)] + [0.12 - 0.003 * n for n in range(1, 21)]
    hits_found, _ = passes(slips, hits=1)
    assert any(hits_found[:40])
    assert not any(hits_found[55:])
    assert slips[55] > PEAK


def test_forgotten_is_as_at_the_start():
    p, (_, s) = numbers_of(SlipPeakParameters()), passes(RISING)
    start_again(SlipPeakState)(s)
    assert (s.slip, s.falling, s.peak, s.fit.taken) == (0.0, 0.0, 0.0, 0.0)
    watch_slip(p, s, PERIOD, 0.1, 0.3)
    assert not peak_is_passed(p, s, 1e-4)
