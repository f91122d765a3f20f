"""Beyond means: shares of runs below each cost, and how probable it is that a law is better than another one.

Agarwal et al. (2021), NeurIPS 34, sections 4.2 and 4.3, with intervals by a bootstrap within each
cell (stratified).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ev_study.benchmark.ranking.scores import ENDS, LARGEST, resampled_draws

COSTS_SHOWN = np.linspace(0.0, LARGEST, 61)


class Estimate(NamedTuple):
    """Numbers and the ends of their 95 % intervals, arrays of one shape."""

    value: np.ndarray
    low: np.ndarray
    high: np.ndarray


def performance_profiles(costs: np.ndarray, seed: int) -> Estimate:
    """The share of the runs of each law that cost no more than each of COSTS_SHOWN, (laws, costs shown)."""
    found = [_mean((law[:, :, None] <= COSTS_SHOWN).astype(float), seed) for law in costs]
    return Estimate(*(np.stack(each) for each in zip(*found, strict=True)))


def improvement(costs: np.ndarray, seed: int) -> Estimate:
    """The probability that a law (row) costs less than another one (column) in the same draw, ties count half.

    Agarwal et al. compare every run with every run; here both laws have driven the same draws,
    which tells more.
    """
    found = [_mean(np.moveaxis(0.5 + 0.5 * np.sign(costs - law), 0, -1), seed) for law in costs]
    return Estimate(*(np.stack(each) for each in zip(*found, strict=True)))


def _mean(of_runs: np.ndarray, seed: int) -> Estimate:
    """The mean over cells and draws of (cells, draws, n), and its interval.

    The sums are exact, so equal anywhere.
    """
    cells, draws, _ = of_runs.shape
    flat = of_runs.reshape(cells * draws, -1)
    means = np.concatenate([counts @ flat for counts in _counts(cells, draws, seed)]) / len(flat)
    return Estimate(flat.mean(axis=0), *np.percentile(means, ENDS, axis=0))


def _counts(cells: int, draws: int, seed: int) -> Iterator[np.ndarray]:
    """Count each run in each resampled board, some boards at once, (boards, cells x draws)."""
    for chosen in resampled_draws(cells, draws, seed):
        # Draw d of cell c is run c draws + d of the flat array.
        places = chosen + draws * np.arange(cells)[:, None]
        yield np.stack(
            [np.bincount(each.ravel(), minlength=cells * draws) for each in places]
        ).astype(float)
