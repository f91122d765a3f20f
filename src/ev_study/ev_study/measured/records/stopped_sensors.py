"""Sensors that show one number while the car turns: they have stopped, or are at the end of their range.

A logger that holds the last value of a sensor, and a sensor that shows no more than its range,
leave numbers that look like any others. What gives them away is that they stay the same to the bit
while what they follow moves on. A steering angle follows nothing: a driver may hold it.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.ndimage import uniform_filter1d

from ev_study.measured.records.samples import Sampled

_SHORTEST = 0.3  # [s] that a number stays the same; a slow sensor may be held for less
_ANSWERS = 0.2  # [s] by which a car and its sensors may be behind what they follow
_HOLDS = 3.0  # times as long as a number of this sensor usually stays
_FAST = 3.0  # [m/s], from which on a car shows how it drives
_MEAN = 0.1  # [s] over which what a sensor follows is averaged: its noise is no movement
_LEAST = 0.1  # share of its range that what is followed has to move by
# At the crest of a wave a sensor with steps of a share s of its range stays the same for 4 sqrt(s)
# of a radian, in which what is ahead of it moves by up to 2 sqrt(s) of its own range.
_OF_STEPS = 3.0


def stopped(
    sensor: Sampled, followed: np.ndarray, speed: np.ndarray, instants: np.ndarray
) -> np.ndarray:
    """Mark where a sensor stands still though the moving car does not, (n,) bool.

    `followed` has what it follows, in any unit, and `speed` that of the car [m/s] at the instants
    [s] of the record, (n,) each.
    """
    found = np.zeros(len(instants), bool)
    known = np.isfinite(sensor.values)
    time, values = sensor.time[known], sensor.values[known]
    # Runs of equal numbers: where each begins, ends, and how long it lasts.
    changes = np.flatnonzero(np.diff(values))
    begins = np.concatenate([[0], changes + 1])
    ends = np.concatenate([changes, [len(values) - 1]])
    durations = time[ends] - time[begins]
    # A slow sensor in a fast log holds each number for some instants by nature.
    least = max(_SHORTEST, _HOLDS * float(np.median(durations)))
    moves = np.abs(speed) > _FAST
    # One number throughout is not a sensor that has stopped; `plausibility` looks for that.
    if not len(changes) or not moves.any():
        return found
    # The smallest change there is: the resolution of the sensor, as a share of its range.
    step = np.abs(np.diff(values)[changes]).min() / np.ptp(values)
    period = instants[1] - instants[0]
    smooth = uniform_filter1d(followed, max(round(_MEAN / period), 1))
    most = max(_LEAST, _OF_STEPS * float(np.sqrt(step))) * np.ptp(smooth[moves])
    for place in np.flatnonzero(durations >= least):
        # What it follows may still move at the end: the car answers only afterwards.
        first, last = np.searchsorted(instants, (time[begins[place]], time[ends[place]]))
        before = slice(first, max(last - round(_ANSWERS / period), first))
        driven = smooth[before][moves[before]]
        if len(driven) and np.ptp(driven) > most:
            found[first : last + 1] = True
    return found


def in_words(by_channel: Mapping[str, np.ndarray], period: float) -> tuple[str, ...]:
    """A line for each channel that stands still somewhere, with how long it does [s]."""
    return tuple(
        f"{name} shows one number for {period * where.sum():.2f} s though the car turns, and is"
        " masked there: the sensor has stopped, or is at the end of its range"
        for name, where in by_channel.items()
        if where.any()
    )
