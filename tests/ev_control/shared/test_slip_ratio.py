"""Slip ratio as the laws count it."""

from __future__ import annotations

import pytest

from ev_control.electronic_differential.rear_targets import slip_ratio


def test_slip_ratio_has_the_divisor_of_the_paper():
    """(10 - 8)/10 driving, (8 - 10)/10 braking, and no slip at rest."""
    assert slip_ratio(10.0, 8.0, 0.5) == pytest.approx(0.2, rel=1e-14)
    assert slip_ratio(8.0, 10.0, 0.5) == pytest.approx(-0.2, rel=1e-14)
    assert slip_ratio(0.0, 0.0, 0.5) == 0.0


def test_slow_wheels_slip_against_the_least_divisor():
    assert slip_ratio(0.1, 0.0, 0.5) == pytest.approx(0.2, rel=1e-14)
