"""The search of CMA-ES: the same optimiser, start and budget for every law, and a choice among its best candidates.

Hansen (2016), The CMA evolution strategy: a tutorial, arXiv:1604.00772, in the package `cma`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ev_study.tuning.free import Free
from ev_study.tuning.training import Answer, Training

STEP = 0.15  # first standard deviation, of the way between the bounds


class Candidate(NamedTuple):
    """Values by name, their shares of the way between the bounds, and their cost."""

    values: Mapping[str, float]
    shares: np.ndarray
    cost: float


def search(
    training: Training, free: Sequence[Free], budget: int, seed: int, answer: Answer
) -> Iterator[Candidate]:
    """Candidates, the start first, one after the other until the budget of them is used up.

    `answer` is asked for the costs at shares (n, parameters) and a function that computes them: it
    may know them. The same seed gives the same candidates on the same machine; the eigenvectors are
    those of its linear algebra.
    """
    import cma  # slow to import

    start = np.array([each.share for each in free])
    # The start is a candidate as well: a search that finds nothing better gives it back.
    yield from _judged(training, free, start[None, :], answer)
    random = np.random.Generator(np.random.PCG64(seed))
    # NaN keeps cma from seeding numpy's global generator; its numbers come from ours.
    options = {
        "bounds": [0.0, 1.0],
        "seed": np.nan,
        "randn": lambda *shape: random.standard_normal(shape),
        # Nothing is printed.
        "verbose": -9,
    }
    strategy, used = cma.CMAEvolutionStrategy(start, STEP, options), 1
    while used < budget:
        asked = strategy.ask()
        # The last generation may be cut by the budget; then there is nothing to learn from any
        # more.
        found = _judged(training, free, np.array(asked)[: budget - used], answer)
        yield from found
        used += len(found)
        if used < budget:
            strategy.tell(asked, [each.cost for each in found])


def chosen(
    found: Sequence[Candidate],
    validation: Training,
    free: Sequence[Free],
    finalists: int,
    answer: Answer,
) -> tuple[Candidate, float, float]:
    """The candidate of the least cost on other runs, among the start and the best ones.

    Its cost and the start's there.

    The start comes first, so it stays where no candidate is better.
    """
    start, *others = found
    # At equal costs the earlier candidate stays in front, since the sort is stable.
    best = [start, *sorted(others, key=lambda each: each.cost)[:finalists]]
    judged = _judged(validation, free, np.array([each.shares for each in best]), answer)
    costs = [each.cost for each in judged]
    least = int(np.argmin(costs))
    return best[least], costs[least], costs[0]


def _judged(
    training: Training, free: Sequence[Free], shares: np.ndarray, answer: Answer
) -> list[Candidate]:
    values = [_values(free, row) for row in shares]
    costs = answer(shares, lambda _: training.costs(values))
    return [Candidate(*each) for each in zip(values, shares, costs.tolist(), strict=True)]


def _values(free: Sequence[Free], shares: np.ndarray) -> dict[str, float]:
    """The values at some shares; the start to the bit."""
    pairs = zip(free, shares.tolist(), strict=True)
    return {
        each.name: each.start if share == each.share else each.value(share) for each, share in pairs
    }
