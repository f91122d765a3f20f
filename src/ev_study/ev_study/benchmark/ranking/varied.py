"""Effects of a board's variations on its laws: runs with the least against those with the most."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from scipy.stats import t as student

from ev_study.benchmark.board import MOTOR_FAULT, Board, Cell, Variation
from ev_study.benchmark.draws import numbers_drawn
from ev_study.benchmark.ranking.scores import CONFIDENCE


class Difference(NamedTuple):
    """Rise of a number from the least to the most, and half the width of its interval.

    Both are NaN with too few runs.
    """

    value: float
    half: float

    def in_words(self, scale: float, digits: int) -> str:
        """Times a scale, `tied` if the interval has zero in it; a dash of too few runs."""
        if math.isnan(self.half):
            return "-"
        is_tied = abs(self.value) <= self.half
        return (
            "tied"
            if is_tied
            else f"{scale * self.value:+.{digits}f} ± {scale * self.half:.{digits}f}"
        )


class Varied(NamedTuple):
    """The least and the most of what is drawn, in words, and by what is counted the difference of each law."""

    least: str
    most: str
    differences: dict[str, list[Difference]]


def differences_by_variation(
    board: Board, cells: Sequence[Cell], counted: Mapping[str, np.ndarray]
) -> dict[str, Varied]:
    """Differences of what is `counted` of each run, (laws, cells, draws), by variation.

    Compared are the runs with the least and the greatest third of a range, the least and the
    greatest choice, or none and a fault of MOTOR_FAULT. A variation of a single choice is left out.
    """
    # Drawn once more: the seed gives the same numbers, and no record has to hold them.
    of_cells, found = [numbers_drawn(board, cell)[1] for cell in cells], {}
    for variation in board.variations:
        if len(set(variation.choice)) != 1:
            drawn = np.array([of[variation.parameter] for of in of_cells])
            (least, with_least), (most, with_most) = _extremes(variation, drawn)
            of = {
                name: mantel_haenszel(values, with_least, with_most)
                for name, values in counted.items()
            }
            found[variation.parameter] = Varied(least, most, of)
    return found


def _extremes(variation: Variation, drawn: np.ndarray) -> tuple[tuple[str, Any], tuple[str, Any]]:
    """The least and the most, in words, and which runs have it."""
    if variation.parameter == MOTOR_FAULT:
        return ("none", drawn == ""), ("of one motor", drawn != "")
    if variation.choice:
        low, high = min(variation.choice), max(variation.choice)
        return (f"{low:g}", drawn == low), (f"{high:g}", drawn == high)
    low, high = variation.bounds
    below, above = low + (high - low) / 3.0, high - (high - low) / 3.0
    if variation.count:
        below, above = math.floor(below), math.ceil(above)
    least, most = (
        f"{begin:.4g}" if begin == end else f"{begin:.4g} to {end:.4g}"
        for begin, end in ((low, below), (above, high))
    )
    return (least, drawn <= below), (most, drawn >= above)


def mantel_haenszel(
    values: np.ndarray, with_least: np.ndarray, with_most: np.ndarray
) -> list[Difference]:
    """Differences of values, (laws, cells, draws), between two kinds of runs, (cells, draws).

    They are taken within cells. A cell has the weight n_1 n_2/(n_1 + n_2), so that it counts for
    nothing which cells happen to have more runs with the most. All cells together give a variance
    for each kind of runs, and Student's t with the freedom of the fewer ones the interval.
    """
    # A cell without runs of either kind has no difference.
    both = with_least.any(axis=-1) & with_most.any(axis=-1)
    values, kinds = values[:, both], np.stack([with_least[both], with_most[both]])
    counts = kinds.sum(axis=-1)
    freedom = (counts - 1).sum(axis=-1)
    # One run in each cell has no variance.
    if not freedom.min():
        return [Difference(math.nan, math.nan)] * len(values)
    # n_1 n_2/(n_1 + n_2): the inverse of the variance of a difference, up to the variance of a run.
    weights = counts.prod(axis=0) / counts.sum(axis=0)
    means, variance = [], np.zeros(len(values))
    for runs, count, free in zip(kinds, counts, freedom, strict=True):
        mean = (values * runs).sum(axis=-1) / count
        squares = ((values - mean[..., None]) ** 2 * runs).sum(axis=(-2, -1))
        variance += squares / free * (weights**2 / count).sum()
        means.append(mean)
    found = (means[1] - means[0]) @ weights / weights.sum()
    # Of the two kinds of runs the fewer decide: a safe side of the freedom.
    halves = student.ppf(0.5 + 0.5 * CONFIDENCE, freedom.min()) * np.sqrt(variance) / weights.sum()
    return [Difference(*of) for of in zip(found.tolist(), halves.tolist(), strict=True)]
