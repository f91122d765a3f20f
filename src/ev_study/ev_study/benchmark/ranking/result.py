"""Result of a board: scores of all laws, records of all runs, and what is written of them."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterator, Mapping, Sequence
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


class _Counted(NamedTuple):
    """Counts of each cell: unstable runs, met demand and costs, (laws, draws), recorded metrics.

    With them come the cells themselves, and the number of runs driven in all of them.
    """

    unstable: list[np.ndarray]
    met: list[np.ndarray]
    costs: dict[str, list[np.ndarray]]
    places: list[Cell]
    recorded: dict[str, list[np.ndarray]]
    driven: int


@dataclass(frozen=True)
class BoardResult:
    """A board, the laws and cells of it that were driven, in this order; `words` of the command that drives a cell.

    `step_times` are what was read of a clock (`step_times.step_times`), so that they count in no
    hash.
    """

    board: Board
    laws: Sequence[str]
    cells: Sequence[DrivenCell]
    words: Sequence[str] = ()
    step_times: Mapping[str, float] = field(default_factory=dict)

    @cached_property
    def _counted(self) -> _Counted:
        """Counts of all cells: one after the other, to spare memory."""
        board, counted = self.board, _Counted([], [], {cost: [] for cost in COSTS}, [], {}, 0)
        for cell in self.cells:
            manoeuvre, of_laws = (
                board.manoeuvres[cell.cell.manoeuvre],
                [cell.laws[law].metrics for law in self.laws],
            )
            sideslip = np.array([of["peak_sideslip"] for of in of_laws])
            unstable = ~(sideslip < board.unstable) | ~np.array(
                [cell.laws[law].clean for law in self.laws]
            )
            counted.unstable.append(unstable)
            counted.met.append(
                np.broadcast_to(demand_met(board, manoeuvre, cell.metrics), unstable.shape)
            )
            for cost, of in counted.costs.items():
                of.append(costs_of(board, manoeuvre, cost, cell.metrics, unstable))
            for name in named_metrics(manoeuvre.metrics("recorded")):
                counted.recorded.setdefault(name, []).append(np.array([of[name] for of in of_laws]))
            counted.places.append(cell.cell)
            driven = sum(int(of[DRIVEN].sum()) if DRIVEN in of else board.draws for of in of_laws)
            counted = counted._replace(driven=counted.driven + driven)
        return counted

    @cached_property
    def unstable(self) -> np.ndarray:
        """Mask of runs, (laws, cells, draws): slid too far, not finite, or not clean."""
        return np.stack(self._counted.unstable, axis=1)

    @cached_property
    def met(self) -> np.ndarray:
        """The share of the demand that each run meets, (laws, cells, draws)."""
        return np.stack(self._counted.met, axis=1)

    @cached_property
    def costs(self) -> dict[str, np.ndarray]:
        """Costs of each run by cost, (laws, cells, draws)."""
        return {cost: np.stack(of, axis=1) for cost, of in self._counted.costs.items()}

    @cached_property
    def middles(self) -> dict[str, np.ndarray]:
        """Interquartile mean of each law in each cell by cost, (laws, cells)."""
        return {cost: interquartile_mean(of) for cost, of in self.costs.items()}

    @cached_property
    def _bootstraps(self) -> dict[str, np.ndarray]:
        """The `bootstrap` of all laws by score; those of some of them are its columns."""
        handling, energy, seed = self.costs["handling"], self.costs["energy"], self.board.seed
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
        return {of: ranked(each[:, list(laws)]) for of, each in self._bootstraps.items()}

    @cached_property
    def profiles(self) -> dict[str, Estimate]:
        """Performance profile of each law by cost, (laws, costs shown)."""
        return {cost: performance_profiles(of, self.board.seed) for cost, of in self.costs.items()}

    @cached_property
    def improvement(self) -> dict[str, Estimate]:
        """Probability that a law is better than another one, by cost, (laws, laws)."""
        return {cost: improvement(of, self.board.seed) for cost, of in self.costs.items()}

    @property
    def places(self) -> list[Cell]:
        """The cells without what was driven, which may be on disk."""
        return self._counted.places

    @property
    def driven(self) -> int:
        """Number of driven runs, those for an entry speed among them."""
        return self._counted.driven

    @cached_property
    def recorded(self) -> dict[str, np.ndarray]:
        """Medians of metrics without a cost, over all runs that have them, (laws,).

        NaN if none has.
        """
        return {
            name: medians(np.concatenate(of, axis=1)) for name, of in self._counted.recorded.items()
        }

    @cached_property
    def varied(self) -> dict[str, Varied]:
        """Differences of handling and unstable runs of each law by variation."""
        counted = {"handling": self.costs["handling"], "unstable": self.unstable}
        return differences_by_variation(self.board, self.places, counted)

    def once_more(self, cell: int, law: int, draw: int) -> str:
        """The line that drives a run alone."""
        words = command_of(self.words)
        return f"{words} --cells '{self.places[cell].id('*')}' --drive {self.laws[law]}:{draw}"

    def runs(self) -> Iterator[dict[str, Any]]:
        """A record of each run: its metrics, None where there is no number, signal hash, and what drives it again."""
        for n, cell in enumerate(self.cells):
            for i, law in enumerate(self.laws):
                driven = cell.laws[law]
                for draw, command in enumerate(driven.commands):
                    numbers = {name: float(values[draw]) for name, values in driven.metrics.items()}
                    costs = {
                        f"{cost}_cost": float(of[i, n, draw]) for cost, of in self.costs.items()
                    }
                    yield {
                        "cell": cell.cell.id("*"),
                        "law": law,
                        "draw": draw,
                        "unstable": bool(self.unstable[i, n, draw]),
                        "demand_met": float(self.met[i, n, draw]),
                        **costs,
                        **{name: _number(value) for name, value in numbers.items()},
                        "signal_hash": driven.hashes[draw],
                        "command": command,
                        "once_more": self.once_more(n, i, draw),
                    }

    @cached_property
    def hash(self) -> str:
        """SHA-256 of what was drawn and measured in all runs, and of their signals: a list of JSON, run by run."""
        digest, before = hashlib.sha256(b"["), b""
        for run in self.runs():
            kept = {name: value for name, value in run.items() if name != "once_more"}
            digest.update(before + json.dumps(kept, sort_keys=True).encode())
            before = b", "
        digest.update(b"]")
        return digest.hexdigest()

    def as_json(self) -> dict[str, Any]:
        """The scores of all laws, profiles, probabilities of improvement, and the hash of all runs."""
        return {
            "board": self.board.name,
            "version": self.board.version,
            "draws": self.board.draws,
            "runs_driven": self.driven,
            "cells": [each.id("*") for each in self.places],
            "scores": {
                law: {of: each[i]._asdict() for of, each in self.scores.items()}
                | {
                    "unstable": float(self.unstable[i].mean()),
                    "demand_met": float(self.met[i].mean()),
                }
                for i, law in enumerate(self.laws)
            },
            "recorded": {
                law: {name: _number(of[i]) for name, of in self.recorded.items()}
                for i, law in enumerate(self.laws)
            },
            "profiles": {"cost": COSTS_SHOWN.tolist()}
            | {
                law: {c: _lists(of, i) for c, of in self.profiles.items()}
                for i, law in enumerate(self.laws)
            },
            "probability_of_improvement": {
                law: {
                    other: {
                        cost: {n: each[k] for n, each in _lists(of, i).items()}
                        for cost, of in self.improvement.items()
                    }
                    for k, other in enumerate(self.laws)
                    if k != i
                }
                for i, law in enumerate(self.laws)
            },
            "step_time_ns": {law: round(of) for law, of in self.step_times.items()},
            "hash": self.hash,
        }


def _number(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def medians(values: np.ndarray) -> np.ndarray:
    """Median of each row over the runs that have a number, (laws,); NaN if none has."""
    rows = [of[~np.isnan(of)] for of in values]
    return np.array([np.median(of) if of.size else math.nan for of in rows])


def _lists(of: Estimate, row: int) -> dict[str, list[float]]:
    return {name: values[row].tolist() for name, values in of._asdict().items()}
