"""Simulated time against the wall clock, by a clock that the test turns."""

from __future__ import annotations

import pytest

from ev_msgs_py.contract.stamps import NANOSECONDS
from ev_nodes.master import schedule as pace_module
from ev_nodes.master.schedule import Pace

PERIOD = NANOSECONDS // 100


@pytest.fixture
def wall(monkeypatch):
    clock = [100.0]
    monkeypatch.setattr(pace_module.time, "monotonic", lambda: clock[0])
    return clock


def test_time_that_was_lost_counts_in_the_summary_but_makes_nothing_due(wall):
    """Half a second in one, then a second is lost, then half a second in one again."""
    pace = Pace()
    wall[0] += 1.5
    pace.go_on(NANOSECONDS // 2)
    assert pace.due(NANOSECONDS // 2 + PERIOD, 1.0) == pytest.approx(101.51)
    wall[0] += 0.5
    assert pace.summary(NANOSECONDS, PERIOD) == "1 s simulated in 2.000 s, 50.0 steps/s"


def test_a_rest_counts_nowhere(wall):
    """1 s driven, 10 s of rest through a change of the pace, 0.5 s driven."""
    pace = Pace()
    wall[0] += 1.0
    pace.rest()
    wall[0] += 4.0
    pace.go_on(NANOSECONDS)
    wall[0] += 6.0
    assert pace.summary(NANOSECONDS, PERIOD) == "1 s simulated in 1.000 s, 100.0 steps/s"
    pace.resume(NANOSECONDS)
    assert pace.due(NANOSECONDS + PERIOD, 1.0) == pytest.approx(wall[0] + 0.01)
    wall[0] += 0.5
    assert pace.summary(3 * NANOSECONDS // 2, PERIOD) == "1.5 s simulated in 1.500 s, 100.0 steps/s"


def test_what_has_waited_for_others_is_neither_lost_nor_counted(wall):
    pace = Pace()
    wall[0] += 5.0
    pace.start(PERIOD)
    assert pace.due(2 * PERIOD, 2.0) == pytest.approx(105.005)
    wall[0] += 1.0
    assert pace.summary(101 * PERIOD, PERIOD) == "1 s simulated in 1.000 s, 100.0 steps/s"
