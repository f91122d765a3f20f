"""Compiled look-ups along the road."""

from __future__ import annotations

import numpy as np

from ev_sim.compiled import compiled


@compiled
def segment_at(start: np.ndarray, distance: float, previous: int) -> int:
    """Index of the segment that holds a distance [m], searched from the previous one; `start` [m] rises."""
    index = previous
    while index + 1 < start.shape[0] and distance >= start[index + 1]:
        index += 1
    while index > 0 and distance < start[index]:
        index -= 1
    return index


@compiled
def interpolate(distances: np.ndarray, values: np.ndarray, distance: float, previous: int) -> tuple[float, int]:
    """Linear interpolation between points, constant outside, and the index of the point before."""
    index = segment_at(distances, distance, previous)
    if index + 1 >= distances.shape[0] or distance <= distances[index]:
        return values[index], index
    share = (distance - distances[index]) / (distances[index + 1] - distances[index])
    return values[index] + share * (values[index + 1] - values[index]), index
