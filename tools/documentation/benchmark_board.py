"""The board of docs/benchmark.md: scores of all laws, where each wins and breaks, and cells with how to repeat them.

Beside it tuned laws and their untuned selves on held-out cases.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from documentation.markdown import code, table
from ev_core.parameters.data_file import find_in_config
from ev_stack.report.tables import Table
from ev_study.benchmark.added import with_added
from ev_study.benchmark.board import Board, read_board
from ev_study.benchmark.held_out import held_out
from ev_study.benchmark.ranking.result import BoardResult
from ev_study.benchmark.ranking.scores import difference, interquartile_mean, tail_mean
from ev_study.benchmark.ranking.tables import (
    cell_table,
    closed_division,
    law_table,
    score_table,
)
from ev_study.commands.benchmark import drive_board

PAGE = "docs/benchmark.md"
TUNED = "tuned"
PARTS = (TUNED, "closed", "open", "laws", "cells")
NAME = "small"
IMAGE = "benchmark_board"
HELD_OUT, HELD_OUT_DRAWS = 70613, 5  # a seed that was drawn after the laws had been tuned


def board_tables(result: BoardResult) -> dict[str, str]:
    """The generated parts of the page, by name."""
    driven = (
        f"{len(result.cells)} cells, {result.board.draws} draws, hash of all runs `{result.hash}`."
    )
    closed = score_table(result, closed_division(result))
    laws = score_table(result, result.laws)
    return {
        "closed": _with_code(closed),
        "open": f"{_with_code(laws)}\n{driven}\n",
        "laws": _with_code(law_table(result)),
        "cells": marked_cells(result),
    }


def _with_code(shown: Table) -> str:
    """A table in Markdown with its laws as code."""
    return table(shown.columns, [[code(law), *of] for law, *of in shown.rows])


def marked_cells(result: BoardResult) -> str:
    """A row for each cell."""
    shown = cell_table(result)
    rows = [[code(cell), *of, code(hash), code(line)] for cell, *of, hash, line in shown.rows]
    return table(shown.columns, rows)


def drive_small(pattern: str = "*") -> BoardResult:
    """The cells of the small board that fit."""
    return drive_board(read_board(NAME), pattern)


def _tuned_files() -> dict[str, Path]:
    """By law the file of its tuned parameters."""
    folder = find_in_config("benchmarks/tuned")
    files = sorted(folder.glob("*_tuned.yaml")) if folder else []
    return {path.stem.removesuffix("_tuned"): path for path in files}


def held_out_table() -> str:
    """Tuned laws beside their untuned selves, on cases that nobody has tuned for."""
    board: Board = replace(held_out(read_board(NAME), HELD_OUT), draws=HELD_OUT_DRAWS)
    board, tuned = with_added(board, [f"{law}={path}" for law, path in _tuned_files().items()])
    untuned = list(_tuned_files())
    result = drive_board(board, laws=[board.reference, *untuned, *tuned])
    rows = []
    for law, name in zip(untuned, tuned, strict=True):
        old, new = (result.laws.index(each) for each in (law, name))
        counted: list[tuple[str, Callable[[np.ndarray], np.ndarray]]] = [
            ("handling", interquartile_mean), ("handling", tail_mean), ("energy", interquartile_mean)
        ]  # fmt: skip
        cells = []
        for cost, statistic in counted:
            of = result.costs[cost]
            less, low, high = difference(of[new], of[old], statistic, board.seed)
            sign = "better" if high < 0.0 else "worse" if low > 0.0 else "tied"
            before, after = (float(statistic(of[i].ravel())) for i in (old, new))
            cells += [
                f"{before:.3f}",
                f"{after:.3f}",
                f"{less:+.3f} [{low:+.3f}, {high:+.3f}] {sign}",
            ]
        unstable = [f"{100.0 * result.unstable[i].mean():.1f}" for i in (old, new)]
        rows.append([code(law), *cells, *unstable])
    columns = ["law"]
    for of in ("handling", "worst tenth", "energy"):
        columns += [of, "tuned", "difference"]
    driven = (
        f"{len(result.cells)} held-out cells of seed {HELD_OUT}, {board.draws} draws, hash of all"
        f" runs `{result.hash}`."
    )
    return f"{table([*columns, 'unstable [%]', 'tuned'], rows)}\n{driven}\n"
