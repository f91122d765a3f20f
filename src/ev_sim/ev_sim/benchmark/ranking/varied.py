"""What the variations of a board do to its laws: the runs at both ends of what is drawn, against each other."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import NormalDist
from typing import Any, NamedTuple

import numpy as np

from ev_sim.benchmark.board import MOTOR_FAULT, Board, Cell, Variation
from ev_sim.benchmark.draws import numbers_drawn
from ev_sim.benchmark.ranking.scores import CONFIDENCE

_DEVIATIONS = NormalDist().inv_cdf(0.5 + 0.5 * CONFIDENCE)


class End(NamedTuple):
    """What is drawn there, in words, and which runs have it, (cells, draws)."""

    text: str
    runs: np.ndarray


class Difference(NamedTuple):
    """By how much something is more at the greater end, and half the width of its interval; NaN of too few runs."""

    value: float
    half: float

    @property
    def is_beyond_noise(self) -> bool:
        """Whether the interval excludes zero."""
        return abs(self.value) > self.half


def ends_of_variations(board: Board, cells: Sequence[Cell]) -> dict[str, tuple[End, End]]:
    """By variation the runs with the least third of its range and those with the greatest.

    Of a choice or a whole number they are those with the least and the greatest one; of MOTOR_FAULT those without a
    fault and those with one.
    """
    of_cells = [numbers_drawn(board, cell)[1] for cell in cells]
    return {each.parameter: _ends(each, [of[each.parameter] for of in of_cells]) for each in board.variations}


def _ends(variation: Variation, drawn: list[list[Any]]) -> tuple[End, End]:
    found = np.array(drawn)
    if variation.parameter == MOTOR_FAULT:
        return End("none", found == ""), End("of one motor", found != "")
    if exact := variation.choice or variation.count:
        low, high = min(exact), max(exact)
        return End(f"{low:g}", found == low), End(f"{high:g}", found == high)
    low, high = variation.bounds
    third = (high - low) / 3.0
    return (
        End(f"{low:.3g} to {low + third:.3g}", found <= low + third),
        End(f"{high - third:.3g} to {high:.3g}", found >= high - third),
    )


def differences(values: np.ndarray, ends: tuple[End, End]) -> list[Difference]:
    """Of each law by how much values, (laws, cells, draws), differ between both ends.

    Runs are compared within their cells, which are weighted as Mantel and Haenszel do, n_1 n_2/(n_1 + n_2): which cells
    happen to have more runs at one end counts for nothing. The interval has one variance for all cells.
    """
    counts = np.array([end.runs.sum(axis=-1) for end in ends])
    weights = counts.prod(axis=0) / np.maximum(counts.sum(axis=0), 1)
    freedom = int((counts.sum(axis=0) - 2)[weights > 0.0].sum())
    if not freedom:
        return [Difference(np.nan, np.nan)] * len(values)
    least, greatest = (
        (values * end.runs).sum(axis=-1) / np.maximum(count, 1) for end, count in zip(ends, counts, strict=True)
    )
    squares = sum(
        ((values - mean[..., None]) ** 2 * end.runs).sum(axis=-1)
        for end, mean in zip(ends, (least, greatest), strict=True)
    )
    found = (greatest - least) @ weights / weights.sum()
    variances = squares @ (weights > 0.0) / freedom
    halves = _DEVIATIONS * np.sqrt(variances / weights.sum())
    return [Difference(*of) for of in zip(found.tolist(), halves.tolist(), strict=True)]
