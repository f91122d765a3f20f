"""Losses from an efficiency map at many times at once, for reports: the same numbers as one by one, to the bit."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def map_loss_powers(
    torque: np.ndarray,
    speed: np.ndarray,
    speeds: Sequence[float],
    torques: Sequence[float],
    efficiency: Sequence[float],
) -> np.ndarray:
    """`losses.map_loss_power` [W] at each pair of shaft torque [N m] and speed [rad/s], all (n,)."""
    lowest = speeds[0] if speeds[0] > 0.0 else speeds[1]
    turns, magnitude = np.maximum(np.abs(speed), lowest), np.abs(torque)
    i, share_i = _places(speeds, turns)
    j, share_j = _places(torques, magnitude)
    table = np.reshape(efficiency, (len(speeds), len(torques)))
    low = table[i, j] + share_j * (table[i, j + 1] - table[i, j])
    high = table[i + 1, j] + share_j * (table[i + 1, j + 1] - table[i + 1, j])
    eta = low + share_i * (high - low)
    driving, generating = magnitude * turns * (1.0 / eta - 1.0), magnitude * turns * (1.0 - eta)
    share = np.minimum(np.abs(speed) / lowest, 1.0)
    return np.where(torque * speed >= 0.0, driving, (1.0 - share) * driving + share * generating)


def _places(axis: Sequence[float], values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    points = np.array(axis)
    index = np.clip(np.searchsorted(points, values, side="right") - 1, 0, len(points) - 2)
    share = (values - points[index]) / (points[index + 1] - points[index])
    return index, np.clip(share, 0.0, 1.0)
