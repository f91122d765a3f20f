"""Tuning of a law on a board by CMA-ES: the same optimiser, runs and budget for every law.

Hansen (2016), The CMA evolution strategy: a tutorial, arXiv:1604.00772, in the package `cma`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import Any

import numpy as np

from ev_core.lockstep.configuration import Configuration
from ev_core.parameters.declaration import entries
from ev_msgs_py.refusal import ParameterError, quoted, unknown_name
from ev_sim.batches.batch import batch
from ev_sim.benchmark.board import Board, Cell
from ev_sim.benchmark.driving import BELIEF, ROLE, DrivenCell, LawInCell, drive_cell, laws_in_cell
from ev_sim.benchmark.scores import LARGEST, costs_of

REACH = 2.0  # decades either way of a positive start, within the declared bounds
STEP = 0.15  # first standard deviation, of the way between the bounds


@dataclass(frozen=True, slots=True)
class Free:
    """A parameter that is tuned: its start, and bounds of the value that the optimiser sees, which is in 0 to 1.

    A positive start is changed by factors, any other one by sums.
    """

    name: str
    start: float
    low: float
    high: float

    @property
    def by_factors(self) -> bool:
        """Whether its logarithm is even."""
        return self.low > 0.0

    def value(self, share: float) -> float:
        """The value at a share of the way from the lower to the upper bound."""
        share = min(max(share, 0.0), 1.0)
        if self.by_factors:
            return min(max(self.low * (self.high / self.low) ** share, self.low), self.high)
        return self.low + share * (self.high - self.low)

    @property
    def share(self) -> float:
        """That of the start."""
        if self.by_factors:
            return math.log(self.start / self.low) / math.log(self.high / self.low)
        return (self.start - self.low) / (self.high - self.low)


def free_parameters(board: Board, law: str, configuration: Configuration, patterns: Sequence[str]) -> list[Free]:
    """The numbers of a law whose names fit, with the bounds of their declarations; not what the board draws for it.

    ParameterError if a pattern fits none, or if fewer than two fit: CMA-ES needs two.
    """
    known = {
        each.name: Free(each.name, float(each.default), *_bounds(float(each.default), each.spec.low, each.spec.high))
        for each in entries(configuration.parameters)
        if each.type is float and not (each.is_array or each.spec.read_only) and each.name not in BELIEF
    }
    for pattern in patterns:
        if not any(fnmatchcase(name, pattern) for name in known):
            raise unknown_name(f"number of law {law}", pattern, known)
    found = [free for name, free in known.items() if any(fnmatchcase(name, pattern) for pattern in patterns)]
    if len(found) < 2:
        raise ParameterError(f"--free {quoted(','.join(patterns))} means {len(found)} numbers, allowed are two or more")
    return found


def _bounds(start: float, low: float, high: float) -> tuple[float, float]:
    if start <= 0.0:
        return low, high
    return max(low, start * 10.0**-REACH), min(high, start * 10.0**REACH)


class Training:
    """The runs by which candidates are judged: all draws of some cells, against those of the reference."""

    def __init__(self, board: Board, cells: Sequence[Cell], law: str, cost: str, threads: int | None) -> None:
        self._board, self._cost, self._threads = board, cost, threads
        self._cells: list[tuple[Cell, LawInCell, DrivenCell]] = [
            (cell, laws_in_cell(board, cell, [law])[law], drive_cell(board, cell, [board.reference], threads))
            for cell in cells
        ]

    @property
    def configuration(self) -> Configuration:
        """The law as it is before, with the first car."""
        return self._cells[0][1].run.configurations[ROLE]

    @property
    def runs(self) -> int:
        """Of one candidate."""
        return len(self._cells) * self._board.draws

    def costs(self, candidates: Sequence[Mapping[str, float]]) -> np.ndarray:
        """The mean cost of each candidate, by names its values, (candidates,): all runs count, so the worst ones do.

        Values that are allowed one by one and do not fit together cost the most, and are not driven.
        """
        fitting = [n for n, each in enumerate(candidates) if self._fits(each)]
        costs = np.full(len(candidates), LARGEST)
        if fitting:
            found = [self._of_cell([candidates[n] for n in fitting], *of) for of in self._cells]
            costs[fitting] = np.mean(found, axis=(0, 2))
        return costs

    def _fits(self, candidate: Mapping[str, float]) -> bool:
        try:
            for _, law, _ in self._cells:
                law.run.configurations[ROLE].changed(candidate)
        except ParameterError:
            return False
        return True

    def _of_cell(self, candidates: Sequence[Mapping[str, float]], cell: Cell, law: LawInCell, of: DrivenCell) -> Any:
        board, manoeuvre, count = self._board, self._board.manoeuvres[cell.manoeuvre], len(candidates)
        vary = {name: list(column) * count for name, column in law.vary.items()}
        for name in candidates[0]:
            vary[f"{ROLE}.{name}"] = [each[name] for each in candidates for _ in range(board.draws)]
        metrics = batch(
            law.run.configurations, manoeuvre.duration, vary, metrics=manoeuvre.measured, threads=self._threads
        ).metrics
        reference = {name: np.tile(each, count) for name, each in of.metrics[board.reference].items()}
        both = {board.reference: reference, "": metrics}
        unstable = np.stack([~(each["peak_sideslip"] < board.unstable) for each in both.values()])
        costs = costs_of(both, manoeuvre.metrics(self._cost), board.scales, board.reference, unstable)
        return costs[1].reshape(count, board.draws)


def tune(
    training: Training,
    free: Sequence[Free],
    budget: int,
    seed: int,
    answer: Callable[[np.ndarray, Callable[[np.ndarray], np.ndarray]], np.ndarray],
) -> Iterator[tuple[dict[str, float], float]]:
    """Candidates with their costs, the start first, one after the other until the budget of them is used up.

    `answer` is asked for the costs at shares (n, parameters) and a function that computes them: it may know them. The
    same seed gives the same candidates on the same machine; the eigenvectors are those of its linear algebra.
    """
    import cma  # slow to import

    def computed(shares: np.ndarray) -> np.ndarray:
        return training.costs([_values(free, row) for row in shares])

    start = np.array([each.share for each in free])
    yield {each.name: each.start for each in free}, float(answer(start[None, :], computed)[0])
    random = np.random.Generator(np.random.PCG64(seed))
    options = {
        "bounds": [0.0, 1.0],
        "seed": np.nan,
        "randn": lambda *shape: random.standard_normal(shape),
        "verbose": -9,
    }
    strategy, used = cma.CMAEvolutionStrategy(start, STEP, options), 1
    while used < budget:
        asked = strategy.ask()
        shares = np.array(asked)[: budget - used]
        costs = answer(shares, computed)
        yield from ((_values(free, row), float(cost)) for row, cost in zip(shares, costs, strict=True))
        used += len(shares)
        if used < budget:
            strategy.tell(asked, costs.tolist())


def _values(free: Sequence[Free], shares: np.ndarray) -> dict[str, float]:
    return {each.name: each.value(share) for each, share in zip(free, shares.tolist(), strict=True)}
