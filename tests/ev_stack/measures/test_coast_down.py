"""Intervals of a coast-down, by which the road load is fitted."""

from __future__ import annotations

import numpy as np
import pytest

from ev_stack.manoeuvres.coast_down import FEWEST, decelerations
from ev_stack.measures import motion
from ev_stack.measures.metric import NotMeasured
from ev_stack.recording.recording import Recording


def coasting(duration: float) -> Recording:
    """A car that loses 0.5 m/s in each second, from 20 m/s on."""
    time = np.arange(0.0, duration + 1e-9, 0.01)
    pedals = dict.fromkeys((motion.DRIVE_TORQUE, motion.BRAKE_TORQUE), np.zeros_like(time))
    speed = {"twist.longitudinal": 20.0 - 0.5 * time, "twist.lateral": np.zeros_like(time)}
    return Recording(time, {**pedals, **speed})


def test_ten_seconds_are_ten_intervals_and_enough():
    speed, deceleration = decelerations(coasting(FEWEST))
    assert len(speed) == len(deceleration) == FEWEST
    assert deceleration == pytest.approx(0.5)


def test_less_than_ten_seconds_are_refused():
    """Ten ends of intervals are nine intervals, which last 9 s."""
    with pytest.raises(NotMeasured, match=r"for less than 10 s$"):
        decelerations(coasting(FEWEST - 0.5))
