"""Cases drawn by one seed: cars, roads and draws to tune on, to choose by, or held out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ev_msgs_py.refusal import ParameterError
from ev_study.benchmark.board import Board, Cases, Road


def held_out(board: Board, seed: int) -> Board:
    """A board with the cases that it holds out."""
    return with_cases(board, "held_out", seed)


def with_cases(board: Board, entry: str, seed: int) -> Board:
    """A board with the cars of one of its CASES, its roads with drawn frictions and stiffnesses, further variations.

    All of it follows from the seed, which is that of the draws as well. ParameterError if it has no
    such entry.
    """
    of: Cases | None = getattr(board, entry)
    if of is None:
        raise ParameterError(
            f"board {board.name} has no {entry} cases, expected an entry {entry} in its file"
        )
    random, roads = np.random.Generator(np.random.PCG64(seed)), dict[str, Road]()
    for name, road in board.roads.items():
        # One pair for each road, in the order of the board: more draws leave the roads as they are.
        friction, stiffness = (
            low + (high - low) * random.random() for low, high in (of.friction, of.stiffness)
        )
        roads[name] = replace(road, friction=float(friction), stiffness=float(stiffness))
    variations = [*board.variations, *of.variations]
    return replace(board, seed=seed, cars=of.cars, roads=roads, variations=variations)
