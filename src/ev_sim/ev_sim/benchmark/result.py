"""What a board has given: rows of all runs, scores of all laws, and tables of both."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ev_sim.benchmark.board import COSTS, Board
from ev_sim.benchmark.driving import DrivenCell
from ev_sim.benchmark.scores import Score, costs_of, interquartile_mean, scores, tail_mean

COLUMNS = ("law", "handling", "rank", "worst tenth", "rank", "energy", "rank", "unstable [%]")
CELL_COLUMNS = ("cell", *(f"{cost}: {which}" for cost in COSTS for which in ("best", "cost")), "once more")


@dataclass(frozen=True)
class BoardResult:
    """A board, the laws and cells of it that were driven, in this order."""

    board: Board
    laws: Sequence[str]
    cells: Sequence[DrivenCell]

    @cached_property
    def unstable(self) -> np.ndarray:
        """Which runs are, (laws, cells, draws): they slid too far, or ended with a number that is not finite."""
        sideslip = [[cell.metrics[law]["peak_sideslip"] for cell in self.cells] for law in self.laws]
        return ~(np.array(sideslip) < self.board.unstable)

    @cached_property
    def costs(self) -> dict[str, np.ndarray]:
        """By cost what each run costs, (laws, cells, draws)."""
        found: dict[str, list[np.ndarray]] = {cost: [] for cost in COSTS}
        for n, cell in enumerate(self.cells):
            manoeuvre = self.board.manoeuvres[cell.cell.manoeuvre]
            for cost in COSTS:
                texts, board = getattr(manoeuvre, cost), self.board
                unstable = self.unstable[:, n]
                found[cost].append(costs_of(cell.metrics, texts, board.scales, board.reference, unstable))
        return {cost: np.stack(each, axis=1) for cost, each in found.items()}

    @cached_property
    def scores(self) -> dict[str, list[Score]]:
        """By what counts a score of each law: middle half and worst tenth of handling, middle half of energy."""
        seed = self.board.seed
        return {
            "handling": scores(self.costs["handling"], interquartile_mean, seed),
            "worst tenth": scores(self.costs["handling"], tail_mean, seed),
            "energy": scores(self.costs["energy"], interquartile_mean, seed),
        }

    def rows(self) -> list[list[str]]:
        """A row for each law below COLUMNS, the best handling first."""
        order = sorted(range(len(self.laws)), key=lambda i: (self.scores["handling"][i].rank, i))
        return [
            [
                self.laws[i],
                *(text for each in self.scores.values() for text in _in_words(each[i])),
                f"{100.0 * self.unstable[i].mean():.1f}",
            ]
            for i in order
        ]

    def cell_rows(self) -> list[list[str]]:
        """A row for each cell below CELL_COLUMNS: the law with the least middle cost, and how to repeat it."""
        rows = []
        for n, cell in enumerate(self.cells):
            row = [cell.cell.id("*")]
            for cost in COSTS:
                middle = interquartile_mean(self.costs[cost][:, n])
                best = int(np.argmin(middle))
                row += [self.laws[best], f"{middle[best]:.2f}"]
            rows.append([*row, f"scripts/run.sh benchmark {self.board.name} --cells '{cell.cell.id('*')}'"])
        return rows

    def runs(self) -> list[dict[str, Any]]:
        """A record of each run, with its metrics, None where there is no number, and the command that drives it."""
        found = []
        for n, cell in enumerate(self.cells):
            for i, law in enumerate(self.laws):
                for draw, command in enumerate(cell.commands[law]):
                    numbers = {name: float(values[draw]) for name, values in cell.metrics[law].items()}
                    costs = {f"{cost}_cost": float(of[i, n, draw]) for cost, of in self.costs.items()}
                    found.append(
                        {
                            "cell": cell.cell.id("*"),
                            "law": law,
                            "draw": draw,
                            "unstable": bool(self.unstable[i, n, draw]),
                            **costs,
                            **{name: value if math.isfinite(value) else None for name, value in numbers.items()},
                            "command": command,
                        }
                    )
        return found

    @cached_property
    def hash(self) -> str:
        """SHA-256 of all runs."""
        return hashlib.sha256(json.dumps(self.runs(), sort_keys=True).encode()).hexdigest()

    def as_json(self) -> dict[str, Any]:
        """The scores of all laws, and the hash of all runs."""
        return {
            "board": self.board.name,
            "version": self.board.version,
            "draws": self.board.draws,
            "cells": [each.cell.id("*") for each in self.cells],
            "scores": {
                law: {of: each[i]._asdict() for of, each in self.scores.items()}
                | {"unstable": float(self.unstable[i].mean())}
                for i, law in enumerate(self.laws)
            },
            "hash": self.hash,
        }


def _in_words(score: Score) -> tuple[str, str]:
    return f"{score.value:.3f} [{score.low:.3f}, {score.high:.3f}]", str(score.rank)
