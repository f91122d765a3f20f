"""The board of docs/benchmark.md: scores of all laws, and the best law of each cell with how to repeat it."""

from __future__ import annotations

from documentation.markdown import code, table
from ev_sim.benchmark.board import read_board
from ev_sim.benchmark.result import CELL_COLUMNS, COLUMNS, BoardResult
from ev_sim.commands.benchmark import drive_board

PAGE = "docs/benchmark.md"
PARTS = ("board", "cells")
NAME = "small"


def board_tables(result: BoardResult) -> dict[str, str]:
    """The generated parts of the page, by name."""
    driven = f"{len(result.cells)} cells, {result.board.draws} draws, hash of all runs `{result.hash}`."
    laws = [[code(row[0]), *row[1:]] for row in result.rows()]
    return {"board": f"{table(COLUMNS, laws)}\n{driven}\n", "cells": cell_table(result)}


def cell_table(result: BoardResult) -> str:
    """A row for each cell."""
    rows = [[code(cell), *of[:-1], code(of[-1])] for cell, *of in result.cell_rows()]
    return table(CELL_COLUMNS, rows)


def drive_small(pattern: str = "*") -> BoardResult:
    """The cells of the small board that fit."""
    return drive_board(read_board(NAME), pattern)
