"""The runs by which candidates for the numbers of a law are judged, and the cost of a candidate.

How it works: all candidates of a generation drive all draws of a cell in one batch. Their costs are
those of the board, against the reference in the same draws. The reference is driven once for all
laws; its numbers are kept as answers, so a search that goes on need not drive it again.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from ev_msgs_py.refusal import ParameterError
from ev_stack.batches.by_period import batch_by_period
from ev_stack.measures.own_metrics import named_metrics
from ev_study.benchmark.board import Board, Cell, by_role
from ev_study.benchmark.driving import DrivenCell, DrivenLaw, LawInCell, drive_cell, laws_in_cell
from ev_study.benchmark.ranking.scores import (
    LARGEST,
    WORST,
    costs_of,
    interquartile_mean,
    tail_mean,
)

Answer = Callable[[np.ndarray, Callable[[np.ndarray], np.ndarray]], np.ndarray]


def robust_cost(costs: np.ndarray) -> np.ndarray:
    """Cost of candidates for their comparison, of the costs of their runs along the last axis.

    It is their interquartile mean and their worst tenth, which both rank laws; the tenth counts as
    the tenth that it is.
    """
    return interquartile_mean(costs) + WORST * tail_mean(costs)


class Reference:
    """The runs of the reference of a board in some cells, which are driven once for all laws that are tuned."""

    def __init__(self, board: Board, cells: Sequence[Cell], threads: int | None) -> None:
        self.board, self.cells, self._threads = board, cells, threads
        self._metrics: dict[Cell, Mapping[str, np.ndarray]] = {}

    def driven(self, answer: Answer) -> list[DrivenCell]:
        """Return what was measured, by cell.

        `answer` is asked for it at the number of each cell: it may know it.
        """
        return [self._driven(cell, number, answer) for number, cell in enumerate(self.cells)]

    def _driven(self, cell: Cell, number: int, answer: Answer) -> DrivenCell:
        law = self.board.reference
        names = [*named_metrics(self.board.manoeuvres[cell.manoeuvre].measured)]

        def measured(_: np.ndarray) -> np.ndarray:
            if cell not in self._metrics:
                driven = drive_cell(self.board, cell, [law], self._threads)
                self._metrics[cell] = driven.laws[law].metrics
            return np.array([self._metrics[cell][name] for name in names])

        values = answer(np.array([number]), measured)
        self._metrics[cell] = dict(zip(names, values, strict=True))
        all_clean = np.ones(self.board.draws, bool)  # no entry speed is looked for in training
        return DrivenCell(cell, {law: DrivenLaw(self._metrics[cell], all_clean, [], [])})


class Training:
    """All draws of some cells, against those of the reference in the same cells, which are driven before."""

    def __init__(
        self,
        board: Board,
        law: str,
        reference: Sequence[DrivenCell],
        cost: str,
        threads: int | None,
    ) -> None:
        self._board, self._cost, self._threads = board, cost, threads
        self._cells = [(laws_in_cell(board, of.cell, [law])[law], of) for of in reference]

    @property
    def runs(self) -> int:
        """Number of runs of one candidate."""
        return len(self._cells) * self._board.draws

    @property
    def of_reference(self) -> float:
        """The cost of the reference in the same runs: a candidate above it is worse than no law at all."""
        board, law, found = self._board, self._board.reference, []
        for _, of in self._cells:
            unstable = ~(of.metrics[law]["peak_sideslip"] < board.unstable)[None, :]
            found.append(
                costs_of(
                    board, board.manoeuvres[of.cell.manoeuvre], self._cost, of.metrics, unstable
                )
            )
        return float(robust_cost(np.concatenate(found, axis=1)[0]))

    def costs(self, candidates: Sequence[Mapping[str, float]]) -> np.ndarray:
        """The cost of each candidate, by names its values, (candidates,).

        Values that are allowed one by one and do not fit together cost the most, and are not
        driven.
        """
        # One candidate that is refused would refuse the whole batch.
        fitting = [n for n, each in enumerate(candidates) if self._fits(each)]
        # What runs would cost that are all lost.
        costs = np.full(len(candidates), robust_cost(np.full(1, LARGEST)))
        if fitting:
            found = [self._of_cell([candidates[n] for n in fitting], *of) for of in self._cells]
            costs[fitting] = robust_cost(np.concatenate(found, axis=1))
        return costs

    def _fits(self, candidate: Mapping[str, float]) -> bool:
        try:
            for runs, _ in self._cells:
                for role, values in by_role(candidate).items():
                    runs.run.configurations[role].changed(values)
        except ParameterError:
            return False
        return True

    def _of_cell(
        self, candidates: Sequence[Mapping[str, float]], law: LawInCell, of: DrivenCell
    ) -> np.ndarray:
        board, manoeuvre, count = (
            self._board,
            self._board.manoeuvres[of.cell.manoeuvre],
            len(candidates),
        )
        # All draws of the first candidate, then all of the second: the shape below follows that.
        vary = {name: list(column) * count for name, column in law.vary.items()}
        for role, values in by_role(candidates[0]).items():
            for name in values:
                vary[f"{role}.{name}"] = [
                    by_role(each)[role][name] for each in candidates for _ in range(board.draws)
                ]
        metrics = batch_by_period(
            law.run.configurations,
            manoeuvre.duration,
            vary,
            metrics=manoeuvre.measured,
            threads=self._threads,
        ).metrics
        reference = {
            name: np.tile(each, count) for name, each in of.metrics[board.reference].items()
        }
        # To `costs_of` all candidates together are one law beside the reference.
        both = {board.reference: reference, "": metrics}
        # NaN, a run without a finite number, is unstable as well.
        unstable = np.stack([~(each["peak_sideslip"] < board.unstable) for each in both.values()])
        costs = costs_of(board, manoeuvre, self._cost, both, unstable)
        return costs[1].reshape(count, board.draws)
