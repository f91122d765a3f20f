"""Scores from metrics: costs over a reference, interquartile means, ranks with ties.

Agarwal et al. (2021), Deep reinforcement learning at the edge of the statistical precipice, NeurIPS
34: the mean of the middle half of all runs, with intervals by a bootstrap within each cell
(stratified).

How it works: each run gets a cost against the reference in the same draw, between 0 and LARGEST, so
that one lost car cannot outweigh all others. Scores are means over the costs of all cells and
draws. The bootstrap draws runs again within each cell, alike for all laws, so that the interval of
a difference is that of laws on the same draws.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import NamedTuple

import numpy as np

from ev_stack.measures.metric import HIGHER
from ev_stack.measures.own_metrics import named_metrics
from ev_study.benchmark.board import Board
from ev_study.benchmark.manoeuvre import Manoeuvre

LARGEST = 3.0  # cost of a run that is unstable or lacks a number, and of any other at most
LEAST_MET = 0.5  # share of the demand below which a run costs as much
RESAMPLES, _AT_ONCE = 1000, 20
CONFIDENCE = 0.95
ENDS = 50.0 * (1.0 - CONFIDENCE), 50.0 * (1.0 + CONFIDENCE)  # percentiles
WORST = 0.1  # share of the runs that the tail is the mean of


class Score(NamedTuple):
    """A number of a law over all cells, its interval, and how many laws are better beyond the noise, plus one."""

    value: float
    low: float
    high: float
    rank: int


def costs_of(
    board: Board,
    manoeuvre: Manoeuvre,
    cost: str,
    metrics: Mapping[str, Mapping[str, np.ndarray]],
    unstable: np.ndarray,
) -> np.ndarray:
    """Costs of the runs of a manoeuvre, (laws, draws), by metrics over those of the reference.

    The own cost of a run is the mean of 1 + (x - x_0)/max(|x_0|, scale) of each metric, with the
    sign of what is better, within 0 to LARGEST; 1 without metrics. A run that meets the share m of
    the demand costs m times its own cost and 1 - m times LARGEST, so that no law gains by doing
    less; LARGEST below LEAST_MET, for runs that are `unstable`, (laws, draws), and for those that
    lack a number. A metric that only the reference lacks is 1.
    """
    found = [] if manoeuvre.metrics(cost) else [np.ones(unstable.shape)]
    # From here on: runs that cost LARGEST whatever their metrics are.
    lost = unstable
    for name, metric in named_metrics(manoeuvre.metrics(cost)).items():
        values, more = _over_reference(board, name, metrics)
        # A cost is better low: of what is better high the sign is turned.
        found.append(1.0 + (-more if metric.better == HIGHER else more))
        lost = lost | np.isnan(values)
    # The mean first: a lack in one metric may be made up for in another one.
    own = np.clip(np.mean(found, axis=0), 0.0, LARGEST)
    met = demand_met(board, manoeuvre, metrics)
    lost = lost | (met < LEAST_MET)
    costs: np.ndarray = np.where(lost, LARGEST, met * own + (1.0 - met) * LARGEST)
    return costs


def demand_met(
    board: Board, manoeuvre: Manoeuvre, metrics: Mapping[str, Mapping[str, np.ndarray]]
) -> np.ndarray:
    """The share of the demand that each run meets, (laws, draws), at most 1: what the reference meets in the same draw.

    1 + (x - x_0)/max(|x_0|, scale) within 0 to 1, the least one of all metrics of the demand; 0 without a number, 1
    where only the reference has none, and without a demand.
    """
    least = np.ones((len(metrics), 1))
    for name in named_metrics(manoeuvre.demand):
        values, more = _over_reference(board, name, metrics)
        # More than the reference does is no merit, and pays for no lack elsewhere.
        least = np.minimum(least, np.where(np.isnan(values), 0.0, np.clip(1.0 + more, 0.0, 1.0)))
    return least


def _over_reference(
    board: Board, name: str, metrics: Mapping[str, Mapping[str, np.ndarray]]
) -> tuple[np.ndarray, np.ndarray]:
    """A metric of all laws, and (x - x_0)/max(|x_0|, scale), 0 where the reference has no number, (laws, draws)."""
    base = metrics[board.reference][name]
    values = np.array([of[name] for of in metrics.values()])
    more = (values - base) / np.maximum(np.abs(base), board.scales[name])
    # Where the reference has no number there is nothing to be better or worse than.
    return values, np.where(np.isnan(base), 0.0, more)


def interquartile_mean(costs: np.ndarray) -> np.ndarray:
    """The mean of the middle half along the last axis."""
    # A quarter at each end; of fewer than four runs none is cut.
    cut = costs.shape[-1] // 4
    return np.asarray(np.sort(costs, axis=-1)[..., cut : costs.shape[-1] - cut].mean(axis=-1))


def tail_mean(costs: np.ndarray) -> np.ndarray:
    """The mean of the worst tenth along the last axis, at least of one."""
    count = max(round(WORST * costs.shape[-1]), 1)
    return np.asarray(np.sort(costs, axis=-1)[..., -count:].mean(axis=-1))


def bootstrap(
    costs: np.ndarray, statistic: Callable[[np.ndarray], np.ndarray], seed: int
) -> np.ndarray:
    """A statistic of the costs of each law, (laws, cells, draws), and of RESAMPLES boards.

    The result is (1 + boards, laws). Draws are drawn again within each cell, and alike for all
    laws, for they have driven the same ones.
    """
    laws, cells, draws = costs.shape
    found = [
        # The same draws for all laws: their differences keep what is common to them.
        statistic(costs[:, np.arange(cells)[:, None], each].reshape(laws, -1))
        for chosen in resampled_draws(cells, draws, seed)
        for each in chosen
    ]
    return np.array([statistic(costs.reshape(laws, -1)), *found])


def ranked(found: np.ndarray) -> list[Score]:
    """The scores of some laws of a `bootstrap`, (1 + boards, laws), ranked among themselves.

    A law is better than another one if the interval of their difference says so.
    """
    values, resampled = found[0], found[1:]
    low, high = np.percentile(resampled, ENDS, axis=0)
    # Positive at the lower end of the interval: surely more cost than the other one.
    worse = np.percentile(resampled[:, :, None] - resampled[:, None, :], ENDS[0], axis=0) > 0.0
    ranks = 1 + np.count_nonzero(worse, axis=1)
    return [
        Score(*of)
        for of in zip(*(each.tolist() for each in (values, low, high, ranks)), strict=True)
    ]


def difference(
    one: np.ndarray, other: np.ndarray, statistic: Callable[[np.ndarray], np.ndarray], seed: int
) -> tuple[float, float, float]:
    """Difference of a statistic of the costs of two laws, (cells, draws), and its interval."""
    both = np.stack([one, other])
    cells, draws = one.shape
    found = [
        statistic(both[:, np.arange(cells)[:, None], chosen].reshape(2, _AT_ONCE, -1))
        for chosen in resampled_draws(cells, draws, seed)
    ]
    resampled = np.concatenate(found, axis=1)
    low, high = np.percentile(resampled[0] - resampled[1], ENDS)
    value = statistic(one.ravel()) - statistic(other.ravel())
    return float(value), float(low), float(high)


def resampled_draws(cells: int, draws: int, seed: int) -> Iterator[np.ndarray]:
    """Draw again within each cell, for RESAMPLES boards.

    They come _AT_ONCE at a time, (boards, cells, draws).
    """
    random = np.random.Generator(np.random.PCG64(seed))
    for _ in range(0, RESAMPLES, _AT_ONCE):
        yield random.integers(draws, size=(_AT_ONCE, cells, draws))
