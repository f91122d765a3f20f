"""Profiles and windows of a cycle at many times at once, for reports: the same numbers as one by one, to the bit."""

from __future__ import annotations

import numpy as np

from ev_sim.profiles.cycle_modes import CycleModes
from ev_sim.profiles.profile import Profile
from ev_sim.profiles.windows_by_rule import STOP


def values_at(profile: Profile, times: np.ndarray) -> np.ndarray:
    """`profile.value_at` each of the times [s], both (n,)."""
    points, values = np.array(profile.time), np.array(profile.value)
    begun = np.searchsorted(points, times, side="right")
    start = np.maximum(begun - 1, 0)
    if profile.linear == 0.0:
        return values[start]
    end = np.minimum(begun, len(points) - 1)
    width = np.where(end > start, points[end] - points[start], 1.0)  # outside of the points their values hold
    return values[start] + (values[end] - values[start]) * ((times - points[start]) / width)


def modes_at(modes: CycleModes, times: np.ndarray) -> np.ndarray:
    """`cycle_modes.mode_at` each of the times [s], both (n,)."""
    return np.array([STOP, *modes.mode], int)[np.searchsorted(modes.begin, times, side="right")]
