"""The full board, hours of driving, as the repository keeps it: docs/measured/benchmark_full.json.

`scripts/document.sh --full DIR` writes that file from the folder of `scripts/run.sh benchmark full
--out DIR`. It has scores, middle costs and medians of each law in each cell, and the first digits
of a signal hash, by which tests drive some of its runs again.
"""

from __future__ import annotations

import gzip
import json
import shlex
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from itertools import groupby, zip_longest
from pathlib import Path
from typing import Any

import numpy as np

from ev_msgs_py.refusal import shown
from ev_study.benchmark.board import COSTS, Board, Cell
from ev_study.benchmark.driving import laws_in_cell
from ev_study.benchmark.ranking.result import medians
from ev_study.benchmark.ranking.scores import interquartile_mean, tail_mean
from ev_study.benchmark.ranking.tables import DIGITS
from ev_study.benchmark.ranking.varied import differences_by_variation

FILE = "docs/measured/benchmark_full.json"
ABOUT = ("board", "version", "draws", "runs_driven", "hash", "versions")
_NO_METRICS = (
    "cell",
    "law",
    "draw",
    "unstable",
    "demand_met",
    "signal_hash",
    "command",
    "once_more",
)
_NO_METRICS += tuple(f"{cost}_cost" for cost in COSTS)
_FIGURES = 4  # that a number is kept with


def kept_board(folder: Path, declared: Board) -> dict[str, Any]:
    """What the repository keeps of a board that was driven: numbers of each law, in the order of `laws`.

    ValueError unless it was driven whole, with what is declared and drawn, and the runs are those
    of the scores.
    """
    board = json.loads((folder / "board.json").read_text(encoding="utf-8"))
    laws, cells = list(board["scores"]), {}
    hold_against(board | {"laws": laws}, declared)
    costs: dict[str, list[np.ndarray]] = {cost: [] for cost in COSTS}
    unstable = []
    for cell, runs in _runs_of_cells(folder / "runs.jsonl.gz", declared.cells()):
        of_laws = {law: list(of) for law, of in groupby(runs, key=lambda run: run["law"])}
        if list(of_laws) != laws or any(len(of) != board["draws"] for of in of_laws.values()):
            raise ValueError(
                f"{cell.id('*')} has not {board['draws']} runs of each law of board.json"
            )
        _hold_draws(declared, cell, runs)
        for cost, of_cost in costs.items():
            of_cost.append(_of_runs(of_laws, f"{cost}_cost"))
        unstable.append(_of_runs(of_laws, "unstable"))
        cells[cell.id("*")] = {
            **{cost: _kept(interquartile_mean(of_cost[-1])) for cost, of_cost in costs.items()},
            "unstable": _kept(unstable[-1].mean(axis=-1)),
            "demand_met": _kept(_of_runs(of_laws, "demand_met").mean(axis=-1)),
            "medians": {
                name: _kept(medians(_of_runs(of_laws, name)))
                for name in runs[0]
                if name not in _NO_METRICS
            },
            "hashes": [of[0]["signal_hash"][:DIGITS] for of in of_laws.values()],
        }
    return {
        **{name: board[name] for name in ABOUT},
        "laws": laws,
        "scores": _rounded(board["scores"]),
        "best of each run": _best_of_each_run(costs, unstable),
        "recorded": _rounded(board["recorded"]),
        "where": dict(_by_group(list(cells), costs, unstable)),
        "varied": _by_variation(declared, costs, unstable),
        "cells": cells,
    }


def hold_against(kept: Mapping[str, Any], board: Board) -> None:
    """ValueError unless a board was driven whole: its name, version and draws, all laws and all cells."""
    whole = {
        "board": board.name,
        "version": board.version,
        "draws": board.draws,
        "laws": list(board.laws),
        "cells": [cell.id("*") for cell in board.cells()],
    }
    for name, wanted in whole.items():
        found = list(kept[name]) if isinstance(wanted, list) else kept[name]
        if found != wanted:
            raise ValueError(f"{name} is {shown(found)}, wanted is {shown(wanted)}")


def write_kept(path: Path, kept: dict[str, Any]) -> None:
    """With a line for each cell, so that a change is seen where it is."""
    others = _lines({name: of for name, of in kept.items() if name != "cells"})
    path.write_text(
        f'{{\n{others},\n"cells": {{\n{_lines(kept["cells"])}\n}}\n}}\n', encoding="utf-8"
    )


@cache
def kept() -> dict[str, Any]:
    """The full board as the repository has it."""
    found: dict[str, Any] = json.loads(
        (Path(__file__).parents[2] / FILE).read_text(encoding="utf-8")
    )
    return found


def _lines(of: dict[str, Any]) -> str:
    return ",\n".join(
        f"{json.dumps(name)}: {json.dumps(each, allow_nan=False)}" for name, each in of.items()
    )


def _runs_of_cells(
    path: Path, cells: Sequence[Cell]
) -> Iterator[tuple[Cell, list[dict[str, Any]]]]:
    """Cell by cell what a file has of them; ValueError unless it has these cells in this order."""
    with gzip.open(path, "rt", encoding="utf-8") as lines:
        found = groupby(map(json.loads, lines), key=lambda run: run["cell"])
        for cell, (name, runs) in zip_longest(cells, found, fillvalue=(None, None)):
            if not isinstance(cell, Cell) or name != cell.id("*"):
                raise ValueError("runs.jsonl.gz has other cells than board.json")
            yield cell, list(runs)


def _of_runs(of_laws: dict[str, list[dict[str, Any]]], name: str) -> np.ndarray:
    """A number of all runs of a cell, (laws, draws); NaN where there is none."""
    return np.array([[run[name] for run in runs] for runs in of_laws.values()], float)


def _by_group(
    cells: Sequence[str], costs: dict[str, list[np.ndarray]], unstable: list[np.ndarray]
) -> Iterator[tuple[str, dict[str, Any]]]:
    """Scores of all laws over the cells of a car, a manoeuvre and a road, from each cell's (laws, draws)."""
    for part in (slice(0, 2), slice(2, 3), slice(3, 4)):
        of_cells = [":".join(cell.split(":")[part]) for cell in cells]
        for name in dict.fromkeys(of_cells):
            places = [n for n, of in enumerate(of_cells) if of == name]
            handling, energy, lost = (
                np.concatenate([of[n] for n in places], axis=1)
                for of in (*costs.values(), unstable)
            )
            yield name, _scored(handling, energy, lost)


def _by_variation(
    board: Board, costs: dict[str, list[np.ndarray]], unstable: list[np.ndarray]
) -> dict[str, dict[str, Any]]:
    """By variation the least and the most of what is drawn, and of each law how it differs, with half the interval."""
    counted = {name: np.stack(of, axis=1) for name, of in {**costs, "unstable": unstable}.items()}
    return {
        name: (
            {"drawn": [of.least, of.most]}
            | {
                counts: [_rounded(list(each)) for each in laws]
                for counts, laws in of.differences.items()
            }
        )
        for name, of in differences_by_variation(board, board.cells(), counted).items()
    }


def _hold_draws(board: Board, cell: Cell, runs: Sequence[dict[str, Any]]) -> None:
    """ValueError unless the last law has driven what the board draws, in the first and the last run of a cell."""
    law = list(board.laws)[-1]
    vary = laws_in_cell(board, cell, [law])[law].vary
    for run in (runs[-board.draws], runs[-1]):
        words = shlex.split(run["command"])
        for name, values in vary.items():
            if f"{name}={json.dumps(values[run['draw']])}" not in words:
                raise ValueError(
                    f"{run['cell']} was not driven with the {name} that the board draws"
                )


def _best_of_each_run(
    costs: dict[str, list[np.ndarray]], unstable: list[np.ndarray]
) -> dict[str, Any]:
    """What no choice among the laws beats: scores with the least cost of each run, of handling and energy apart."""
    handling, energy, lost = (
        np.concatenate([of.min(axis=0) for of in of_cells])
        for of_cells in (*costs.values(), unstable)
    )
    return _scored(handling, energy, lost)


def _scored(handling: np.ndarray, energy: np.ndarray, unstable: np.ndarray) -> dict[str, Any]:
    """Scores over the last axis, the runs."""
    return {
        "handling": _kept(interquartile_mean(handling)),
        "worst tenth": _kept(tail_mean(handling)),
        "energy": _kept(interquartile_mean(energy)),
        "unstable": _kept(unstable.mean(axis=-1)),
    }


def _kept(values: np.ndarray) -> Any:
    return _rounded(values.tolist())


def _rounded(of: Any) -> Any:
    """A number, or all that a mapping or a list has; whole ones and None stay."""
    if isinstance(of, dict):
        return {name: _rounded(each) for name, each in of.items()}
    if isinstance(of, list):
        return [_rounded(each) for each in of]
    if not isinstance(of, float):
        return of
    return None if np.isnan(of) else float(f"{of:.{_FIGURES}g}")
