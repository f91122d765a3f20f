"""Result of a board: scores of all laws, and records of all runs.

How it works: a cell is read once, and of it only the numbers that count are held: costs, unstable
runs, demand, medians. All scores are made of these arrays, (laws, cells, draws). Records of single
runs are read again from the store, one cell at a time, so the memory does not grow with them.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ev_stack.command_line.options import command_of
from ev_stack.measures.own_metrics import named_metrics
from ev_study.benchmark.board import COSTS, Board, Cell
from ev_study.benchmark.driving import DrivenCell
from ev_study.benchmark.entry_speed import DRIVEN
from ev_study.benchmark.ranking.distributions import (
    COSTS_SHOWN,
    Estimate,
    improvement,
    performance_profiles,
)
from ev_study.benchmark.ranking.scores import (
    Score,
    bootstrap,
    costs_of,
    demand_met,
    interquartile_mean,
    ranked,
    tail_mean,
)
from ev_study.benchmark.ranking.varied import Varied, differences_by_variation


class _CountedCell(NamedTuple):
    """Numbers of a cell that count, (laws, draws), and of its runs those that were driven."""

    cell: Cell
    unstable: np.ndarray
    met: np.ndarray
    costs: Mapping[str, np.ndarray]
    recorded: Mapping[str, np.ndarray]
    driven: int


@dataclass(frozen=True)
class BoardResult:
    """A board, and the laws and cells of it that were driven, in this order.

    `words` are of the command that drives a cell. `step_times` were read of a clock
    (`step_times.step_times`), so they count in no hash.
    """

    board: Board
    laws: Sequence[str]
    cells: Sequence[DrivenCell]
    words: Sequence[str] = ()
    step_times: Mapping[str, float] = field(default_factory=dict)

    @cached_property
    def _counted(self) -> list[_CountedCell]:
        # One cell after the other: each is read when it is asked for, and all are too many.
        return [self._count(cell) for cell in self.cells]

    def _count(self, cell: DrivenCell) -> _CountedCell:
        board = self.board
        manoeuvre = board.manoeuvres[cell.cell.manoeuvre]
        of_laws = [cell.laws[law] for law in self.laws]

        def measured(name: str) -> np.ndarray:
            return np.array([of.metrics[name] for of in of_laws])

        is_clean = np.array([of.clean for of in of_laws])
        # Not below, and not `>=`: NaN counts as unstable.
        unstable = ~(measured("peak_sideslip") < board.unstable) | ~is_clean
        driven = 0
        for of in of_laws:
            # With a search a draw takes several runs, else one.
            driven += int(of.metrics[DRIVEN].sum()) if DRIVEN in of.metrics else board.draws
        met = demand_met(board, manoeuvre, cell.metrics)
        recorded = named_metrics(manoeuvre.metrics("recorded"))
        return _CountedCell(
            cell.cell,
            unstable,
            # Without a demand it is one number for each law.
            np.broadcast_to(met, unstable.shape),
            {cost: costs_of(board, manoeuvre, cost, cell.metrics, unstable) for cost in COSTS},
            {name: measured(name) for name in recorded},
            driven,
        )

    @cached_property
    def unstable(self) -> np.ndarray:
        """Runs that slid too far, have a number that is not finite, or are not clean.

        (laws, cells, draws).
        """
        return np.stack([each.unstable for each in self._counted], axis=1)

    @cached_property
    def met(self) -> np.ndarray:
        """Share of the demand that each run meets, (laws, cells, draws)."""
        return np.stack([each.met for each in self._counted], axis=1)

    @cached_property
    def costs(self) -> dict[str, np.ndarray]:
        """Costs of each run by kind, (laws, cells, draws)."""
        return {
            cost: np.stack([each.costs[cost] for each in self._counted], axis=1) for cost in COSTS
        }

    @cached_property
    def middles(self) -> dict[str, np.ndarray]:
        """Interquartile mean of each law in each cell by cost, (laws, cells)."""
        return {cost: interquartile_mean(of) for cost, of in self.costs.items()}

    @cached_property
    def _bootstraps(self) -> dict[str, np.ndarray]:
        """The `bootstrap` of all laws by score; those of some of them are its columns."""
        handling = self.costs["handling"]
        energy = self.costs["energy"]
        seed = self.board.seed
        return {
            "handling": bootstrap(handling, interquartile_mean, seed),
            "worst tenth": bootstrap(handling, tail_mean, seed),
            "energy": bootstrap(energy, interquartile_mean, seed),
        }

    @cached_property
    def scores(self) -> dict[str, list[Score]]:
        """Scores of each law: middle half and worst tenth of handling, middle half of energy."""
        return self.scores_among(range(len(self.laws)))

    def scores_among(self, laws: Sequence[int]) -> dict[str, list[Score]]:
        """The scores of some laws, ranked among themselves."""
        # A division is ranked among its laws without another bootstrap.
        return {of: ranked(each[:, list(laws)]) for of, each in self._bootstraps.items()}

    @cached_property
    def profiles(self) -> dict[str, Estimate]:
        """Performance profile of each law by cost, (laws, costs shown)."""
        return {cost: performance_profiles(of, self.board.seed) for cost, of in self.costs.items()}

    @cached_property
    def improvement(self) -> dict[str, Estimate]:
        """Probability that a law is better than another one by cost, (laws, laws)."""
        return {cost: improvement(of, self.board.seed) for cost, of in self.costs.items()}

    @cached_property
    def places(self) -> list[Cell]:
        """The cells without what was driven, which may be on disk."""
        return [each.cell for each in self._counted]

    @property
    def driven(self) -> int:
        """Number of runs that were driven, with those that looked for an entry speed."""
        return sum(each.driven for each in self._counted)

    @cached_property
    def recorded(self) -> dict[str, np.ndarray]:
        """Medians of what counts in no cost over all runs that have it, (laws,); NaN if none."""
        found: dict[str, list[np.ndarray]] = {}
        for cell in self._counted:
            for name, values in cell.recorded.items():
                found.setdefault(name, []).append(values)
        return {name: medians(np.concatenate(of, axis=1)) for name, of in found.items()}

    @cached_property
    def varied(self) -> dict[str, Varied]:
        """Differences of the handling and of the unstable runs of each law by variation."""
        counted = {"handling": self.costs["handling"], "unstable": self.unstable}
        return differences_by_variation(self.board, self.places, counted)

    def once_more(self, cell: int, law: int, draw: int) -> str:
        """The line that drives a run alone."""
        words = command_of(self.words)
        return f"{words} --cells '{self.places[cell].id('*')}' --drive {self.laws[law]}:{draw}"

    def runs(self) -> Iterator[dict[str, Any]]:
        """Give a record of each run: metrics, None without a number, and what drives it again."""
        for n, cell in enumerate(self.cells):
            for i, law in enumerate(self.laws):
                driven = cell.laws[law]
                for draw, command in enumerate(driven.commands):
                    yield {
                        "cell": cell.cell.id("*"),
                        "law": law,
                        "draw": draw,
                        "unstable": bool(self.unstable[i, n, draw]),
                        "demand_met": float(self.met[i, n, draw]),
                        **{
                            f"{cost}_cost": float(of[i, n, draw]) for cost, of in self.costs.items()
                        },
                        **{name: _number(of[draw]) for name, of in driven.metrics.items()},
                        "signal_hash": driven.hashes[draw],
                        "command": command,
                        "once_more": self.once_more(n, i, draw),
                    }

    @cached_property
    def hash(self) -> str:
        """SHA-256 of what was drawn and measured in all runs, and of their signals.

        It is that of a list of JSON, taken run by run.
        """
        digest = hashlib.sha256(b"[")
        # The text of all runs of a large board is not held: it is hashed run by run.
        before = b""
        for run in self.runs():
            # It has the words of this command, which change nothing that was driven.
            del run["once_more"]
            digest.update(before + json.dumps(run, sort_keys=True).encode())
            before = b", "
        digest.update(b"]")
        return digest.hexdigest()

    def as_json(self) -> dict[str, Any]:
        """Return scores of all laws, profiles, probabilities of improvement, hash of all runs."""

        def of_each_law(of: Callable[[int], Any]) -> dict[str, Any]:
            return {law: of(i) for i, law in enumerate(self.laws)}

        def scores(i: int) -> dict[str, Any]:
            unstable = float(self.unstable[i].mean())
            met = float(self.met[i].mean())
            found = {of: each[i]._asdict() for of, each in self.scores.items()}
            return {**found, "unstable": unstable, "demand_met": met}

        def over_others(i: int) -> dict[str, Any]:
            found = {}
            for k, other in enumerate(self.laws):
                if k != i:
                    found[other] = {
                        cost: {name: float(of[i, k]) for name, of in each._asdict().items()}
                        for cost, each in self.improvement.items()
                    }
            return found

        return {
            "board": self.board.name,
            "version": self.board.version,
            "draws": self.board.draws,
            "runs_driven": self.driven,
            "cells": [each.id("*") for each in self.places],
            "scores": of_each_law(scores),
            "recorded": of_each_law(
                lambda i: {name: _number(of[i]) for name, of in self.recorded.items()}
            ),
            "profiles": {
                "cost": COSTS_SHOWN.tolist(),
                **of_each_law(lambda i: {c: _lists(of, i) for c, of in self.profiles.items()}),
            },
            "probability_of_improvement": of_each_law(over_others),
            "step_time_ns": {law: round(of) for law, of in self.step_times.items()},
            "hash": self.hash,
        }


def _number(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def medians(values: np.ndarray) -> np.ndarray:
    """Return the median of each row over the runs that have a number, (laws,); NaN if none."""
    rows = [of[~np.isnan(of)] for of in values]
    return np.array([np.median(of) if of.size else math.nan for of in rows])


def _lists(of: Estimate, row: int) -> dict[str, list[float]]:
    return {name: values[row].tolist() for name, values in of._asdict().items()}
