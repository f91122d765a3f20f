"""Random surfaces along one track, from a seed."""

from __future__ import annotations

from bisect import bisect_right

import numpy as np


def random_segments(
    generator: np.random.Generator,
    surfaces: tuple[str, ...],
    probability: tuple[float, ...],
    length_range: tuple[float, float],
    distance: float,
) -> tuple[tuple[float, ...], tuple[str, ...]]:
    """Starts [m] and surfaces of segments with uniform lengths, until `distance` is covered.

    `length_range` is the shortest and the longest segment [m]. Lengths do not depend on the surface, so
    `probability` [1] is also each surface's expected share of the distance. The first start is 0.
    """
    share = (np.cumsum(probability) / np.sum(probability)).tolist()
    starts, chosen = [0.0], []
    while starts[-1] < distance:
        draw, length = generator.random(), generator.uniform(*length_range)
        chosen.append(surfaces[bisect_right(share, draw)])
        starts.append(starts[-1] + float(length))
    return tuple(starts[:-1]), tuple(chosen)
