"""A first-order filter, by implicit Euler."""

from __future__ import annotations

import pytest

from ev_control.estimation.wheel_dynamics import Filtered, filter_share, follow, forget_filtered


def test_the_first_number_passes():
    s = Filtered()
    assert follow(s, 7.0, 0.1) == 7.0
    assert (s.value, s.known) == (7.0, 1.0)


@pytest.mark.parametrize("time_constant", [0.0, 0.02, 1.0])
def test_a_step_is_closed_by_implicit_euler(time_constant):
    """The gap shrinks by T/(T + dt) in each period, so to (T/(T + dt))^n.

    Without a time constant at once.
    """
    period, s = 0.005, Filtered()
    share = filter_share(period, time_constant)
    follow(s, 0.0, share)
    for n in range(1, 50):
        gap = (time_constant / (time_constant + period)) ** n
        assert follow(s, 1.0, share) == pytest.approx(1.0 - gap, abs=1e-14)


def test_what_is_forgotten_is_as_at_the_start():
    s = Filtered()
    follow(s, 7.0, 0.1)
    forget_filtered(s)
    assert s == Filtered()
