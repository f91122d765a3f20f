"""What becomes one number of a channel over a whole run."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

MINIMUM, MAXIMUM, LARGEST_MAGNITUDE, LAST, MEAN, ROOT_MEAN_SQUARE = range(6)


class Reduction(NamedTuple):
    """A way to make one number of all samples of a channel, such as imu.yaw_rate, from the start on."""

    kind: int
    channel: str


def minimum(channel: str) -> Reduction:
    """Its smallest number."""
    return Reduction(MINIMUM, channel)


def maximum(channel: str) -> Reduction:
    """Its largest number."""
    return Reduction(MAXIMUM, channel)


def largest_magnitude(channel: str) -> Reduction:
    """Its largest magnitude."""
    return Reduction(LARGEST_MAGNITUDE, channel)


def last(channel: str) -> Reduction:
    """Its number at the end."""
    return Reduction(LAST, channel)


def mean(channel: str) -> Reduction:
    """The mean of its samples, one in each control period and both ends."""
    return Reduction(MEAN, channel)


def root_mean_square(channel: str) -> Reduction:
    """The root of the mean of its squares, one in each control period and both ends."""
    return Reduction(ROOT_MEAN_SQUARE, channel)


def result(kind: int, reduced: np.ndarray, instants: int) -> np.ndarray:
    """The numbers that are meant, from what the compiled loop has gathered (`observer`)."""
    if kind == MEAN:
        return reduced / instants
    return np.sqrt(reduced / instants) if kind == ROOT_MEAN_SQUARE else reduced.copy()
