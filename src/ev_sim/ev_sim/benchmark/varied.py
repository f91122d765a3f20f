"""What the variations of a board do to its laws: the runs at either end of what is drawn."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ev_sim.benchmark.board import MOTOR_FAULT, Board, Cell, Variation
from ev_sim.benchmark.cells.draws import numbers_drawn


class End(NamedTuple):
    """What is drawn there, in words, and which runs have it, (cells, draws)."""

    text: str
    runs: np.ndarray


def ends_of_variations(board: Board, cells: Sequence[Cell]) -> dict[str, tuple[End, End]]:
    """By variation the runs with the least third of its range and those with the greatest.

    Of a choice or a whole number they are those with the least and the greatest one; of MOTOR_FAULT those without a
    fault and those with one.
    """
    of_cells = [numbers_drawn(board, cell)[1] for cell in cells]
    return {each.parameter: _ends(each, [of[each.parameter] for of in of_cells]) for each in board.variations}


def _ends(variation: Variation, drawn: list[list[Any]]) -> tuple[End, End]:
    found = np.array(drawn)
    if variation.parameter == MOTOR_FAULT:
        return End("none", found == ""), End("of one motor", found != "")
    if exact := variation.choice or variation.count:
        low, high = min(exact), max(exact)
        return End(f"{low:g}", found == low), End(f"{high:g}", found == high)
    low, high = variation.bounds
    third = (high - low) / 3.0
    return (
        End(f"{low:.3g} to {low + third:.3g}", found <= low + third),
        End(f"{high - third:.3g} to {high:.3g}", found >= high - third),
    )
