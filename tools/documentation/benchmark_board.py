"""The board of docs/benchmark.md: scores of all laws, where each wins and breaks, and cells with how to repeat them."""

from __future__ import annotations

from documentation.markdown import code, table
from ev_sim.benchmark.board import read_board
from ev_sim.benchmark.result import BoardResult
from ev_sim.benchmark.tables import (
    CELL_COLUMNS,
    LAW_COLUMNS,
    SCORE_COLUMNS,
    cell_rows,
    closed_division,
    law_rows,
    score_rows,
)
from ev_sim.commands.benchmark import drive_board

PAGE = "docs/benchmark.md"
PARTS = ("closed", "open", "laws", "cells")
NAME = "small"
IMAGE = "benchmark_board"


def board_tables(result: BoardResult) -> dict[str, str]:
    """The generated parts of the page, by name."""
    driven = f"{len(result.cells)} cells, {result.board.draws} draws, hash of all runs `{result.hash}`."
    closed, laws = (score_rows(result, division) for division in (closed_division(result), result.laws))
    return {
        "closed": table(SCORE_COLUMNS, [[code(law), *of] for law, *of in closed]),
        "open": f"{table(SCORE_COLUMNS, [[code(law), *of] for law, *of in laws])}\n{driven}\n",
        "laws": table(LAW_COLUMNS, [[code(law), *of] for law, *of in law_rows(result)]),
        "cells": cell_table(result),
    }


def cell_table(result: BoardResult) -> str:
    """A row for each cell."""
    rows = [[code(cell), *of, code(signals), code(command)] for cell, *of, signals, command in cell_rows(result)]
    return table(CELL_COLUMNS, rows)


def drive_small(pattern: str = "*") -> BoardResult:
    """The cells of the small board that fit."""
    return drive_board(read_board(NAME), pattern)
