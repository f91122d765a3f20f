"""The line of least curvature within the edges of a course.

Braghin, Cheli, Melzi and Sabbioni (2008), Race driver model, Computers & Structures 86, 1503-1516:
offsets from the middle of the road that make the sum of squared second derivatives of the line
least, a quadratic programme with bounds. It is solved here by a primal-dual interior-point method
(Nocedal & Wright, Numerical Optimization, 2006, chapter 16.6) in sums of one order, because a
library's solver rounds differently by processor, and signals would with it.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ev_core.law import ParameterError
from ev_sim.courses.course import CourseParameters, lengths_to_next, middle_of, normals

_ITERATIONS = 60
_SIGMA, _BACK = 0.1, 0.99  # centring, and share of the way to the bounds
_GAP = 1e-10  # of the curvatures: with it offsets are exact to some micrometres
# Of the matrix of neighbours and their neighbours, both ends of the course folded together.
_BAND = 4


class RacingLine(NamedTuple):
    """A closed line by its points (n, 2) [m].

    It has the curvature there, left positive (n,) [1/m], and the room to both edges (n,) [m].
    `offset` is how far each point lies left of the middle of the road, `step` the length to the
    next one, (n,) [m].
    """

    points: np.ndarray
    curvature: np.ndarray
    left: np.ndarray
    right: np.ndarray
    offset: np.ndarray
    step: np.ndarray


@lru_cache(32)
def racing_line(course: CourseParameters, track: float) -> RacingLine:
    """The line of a car with a track [m].

    ParameterError where the road is narrower than the car and its clearance.
    """
    middle, half = middle_of(course), 0.5 * np.array(course.width)
    bound = half - (0.5 * track + course.clearance)
    if (narrow := np.flatnonzero(bound <= 0.0)).size:
        least = track + 2.0 * course.clearance
        raise ParameterError(
            f"course: the road is {2.0 * half[narrow[0]]:.3g} m wide at point {narrow[0] + 1}, "
            f"expected more than "
            f"{least:.3g} m: track, and course.clearance on both sides"
        )
    across = normals(middle)
    offset = _least_curvature(middle, across, bound)
    points = middle + across * offset[:, None]
    return RacingLine(
        points, curvatures(points), half - offset, half + offset, offset, lengths_to_next(points)
    )


def curvatures(points: np.ndarray) -> np.ndarray:
    """Curvature of a closed line (n, 2) at its points, (n,) [1/m].

    It is that of the circle through each point and its neighbours.
    """
    before, behind = points - np.roll(points, 1, axis=0), np.roll(points, -1, axis=0) - points
    area = before[:, 0] * behind[:, 1] - before[:, 1] * behind[:, 0]
    both = before + behind
    one, other, chord = (
        np.sqrt(leg[:, 0] * leg[:, 0] + leg[:, 1] * leg[:, 1]) for leg in (before, behind, both)
    )
    return 2.0 * area / np.maximum(one * other * chord, 1e-9)


def second_differences(points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Weights (n,) of three points in the second derivative by length.

    The points are the one before, the point itself and the one behind. With the root of the length
    that belongs to the point, so that sums of squares are integrals.
    """
    behind = lengths_to_next(points)
    before = np.roll(behind, 1)
    root = np.sqrt(2.0 / (before + behind))
    return root / before, -root * (1.0 / before + 1.0 / behind), root / behind


def _least_curvature(middle: np.ndarray, across: np.ndarray, bound: np.ndarray) -> np.ndarray:
    """Offsets (n,) within +-`bound` (n,) [m] along `across`: least 1/2 a'Ha + g'a."""
    # H and g of the sum of squared second derivatives of middle + across a: entries on the
    # diagonal, to the next point, and to the one after that.
    before, at, behind = second_differences(middle)
    own = np.roll(behind, 1) ** 2 + at * at + np.roll(before, -1) ** 2
    next_one = _dot(across, np.roll(across, -1, axis=0)) * (at * behind + np.roll(before * at, -1))
    second = _dot(across, np.roll(across, -2, axis=0)) * np.roll(before * behind, -1)
    bent = before[:, None] * np.roll(middle, 1, axis=0) + at[:, None] * middle
    bent = bent + behind[:, None] * np.roll(middle, -1, axis=0)
    pull = np.roll(behind[:, None] * bent, 1, axis=0) + np.roll(before[:, None] * bent, -1, axis=0)
    gradient = _dot(across, pull + at[:, None] * bent)
    a = np.zeros_like(bound)
    low, high = np.full_like(bound, 0.1), np.full_like(bound, 0.1)  # multipliers of the bounds
    # Newton steps on the conditions of the optimum, with multiplier x room = sigma x gap for each
    # bound.
    for _ in range(_ITERATIONS):
        to_low, to_high = a + bound, bound - a
        gap = (math.fsum(to_low * low) + math.fsum(to_high * high)) / (2 * len(a))
        if gap < _GAP:
            return a
        product = own * a + (next_one * np.roll(a, -1) + np.roll(next_one * a, 1))
        product = product + (second * np.roll(a, -2) + np.roll(second * a, 2))
        residual = (product + gradient) + (high - low)
        wanted_low, wanted_high = _SIGMA * gap / to_low - low, _SIGMA * gap / to_high - high
        stiffness = own + (low / to_low + high / to_high)
        # The multipliers are eliminated: they only add to the diagonal, so the band stays as
        # narrow.
        step = _solved(stiffness, next_one, second, (wanted_low - wanted_high) - residual)
        low_step, high_step = wanted_low - low / to_low * step, wanted_high + high / to_high * step
        # No farther than just before a bound, or before a multiplier gets to zero; at most a whole
        # step.
        share = _BACK * min(_most(to_low, step), _most(to_high, -step), 1.0 / _BACK)
        dual = _BACK * min(_most(low, low_step), _most(high, high_step), 1.0 / _BACK)
        a = a + share * step
        low = low + dual * low_step
        high = high + dual * high_step
    raise ParameterError("course: no line of least curvature was found, expected a smoother course")


def _dot(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    return one[:, 0] * other[:, 0] + one[:, 1] * other[:, 1]


def _most(value: np.ndarray, step: np.ndarray) -> float:
    """The share of a step with which the first value comes to zero."""
    falls = step < 0.0
    return float((-value[falls] / step[falls]).min(initial=1e9))


def _solved(
    own: np.ndarray, next_one: np.ndarray, second: np.ndarray, right: np.ndarray
) -> np.ndarray:
    """Solve the cyclic system with these entries beside the diagonal.

    L D L' of the folded order.
    """
    n = len(own)
    # 0, n-1, 1, n-2, ...: neighbours on the ring are then near each other in the row, and a band
    # takes in the corners of the cyclic matrix.
    order = [m for pair in zip(range(n), range(n - 1, -1, -1), strict=True) for m in pair][:n]
    place = {point: where for where, point in enumerate(order)}
    rows = [[0.0] * _BAND + [float(own[point])] for point in order]  # row i: columns i - _BAND to i
    for apart, entries in ((1, next_one), (2, second)):
        for point, value in enumerate(entries.tolist()):
            one, other = place[point], place[(point + apart) % n]
            # Only the lower half is kept; on short rings two entries may meet.
            rows[max(one, other)][_BAND - abs(one - other)] += value
    x, diagonal = [float(right[point]) for point in order], [0.0] * n
    for i, row in enumerate(rows):
        first = max(i - _BAND, 0)
        for j in range(first, i):
            scaled = row[j - i + _BAND]
            for k in range(max(first, j - _BAND), j):
                scaled -= row[k - i + _BAND] * rows[j][k - j + _BAND]
            row[j - i + _BAND] = scaled
        for j in range(first, i):
            factor = row[j - i + _BAND] / diagonal[j]
            row[_BAND] -= factor * row[j - i + _BAND]
            row[j - i + _BAND] = factor
            x[i] -= factor * x[j]
        diagonal[i] = row[_BAND]
    for i in range(n - 1, -1, -1):
        # Back substitution; the forward one went along with the factors.
        x[i] /= diagonal[i]
        for k in range(i + 1, min(i + _BAND + 1, n)):
            x[i] -= rows[k][i - k + _BAND] * x[k]
    return np.array([x[place[point]] for point in range(n)])
