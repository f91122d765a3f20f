"""The way of a set-point from the controller to the inverter that follows it."""

from __future__ import annotations

import pytest

from ev_bench.machines.circuit import follow, send
from ev_bench.machines.described import SetPointState

STEPS = 4  # of a control period


def followed(sent, delay=0.0, change=1e9, resolution=0.0, largest=1e3):
    """Return what an inverter follows, step by step, of set-points sent period by period."""
    path, followed_values = SetPointState(), []
    for period, value in enumerate(sent):
        send(path, float(period), value, largest, resolution)
        followed_values += [
            follow(path, float(period), STEPS, n, delay, change) for n in range(STEPS)
        ]
    return followed_values


def test_without_delay_a_set_point_acts_at_once():
    assert followed([1.0, 2.0]) == [1.0] * 4 + [2.0] * 4


@pytest.mark.parametrize("delay", [1, 3, 4, 6, 9])
def test_a_delay_of_whole_steps_shifts_everything(delay):
    """Before the first set-point arrives the inverter follows zero."""
    sent = [1.0, 2.0, 3.0, 4.0]
    assert followed(sent, float(delay)) == ([0.0] * delay + followed(sent))[: 4 * STEPS]


def test_a_delay_between_two_steps_shares_the_step():
    """The effect of a delay is continuous in it.

    0.25 steps late means a quarter of the old value in that step.
    """
    assert followed([0.0, 4.0], 0.25)[STEPS : STEPS + 2] == [3.0, 4.0]


def test_a_rate_limit_is_a_ramp():
    assert followed([1.0], change=0.25) == [0.25, 0.5, 0.75, 1.0]
    assert followed([0.0, -1.0], change=0.5)[STEPS:] == [-0.5, -1.0, -1.0, -1.0]


def test_set_points_are_rounded_and_kept_within_their_range():
    assert followed([0.3], resolution=0.25)[0] == 0.25
    assert followed([1e300], largest=400.0)[0] == 400.0
