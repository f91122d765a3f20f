"""Cases that nobody has tuned for: other cars, roads and draws of a board, from a seed that is chosen at the end."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ev_msgs_py.refusal import ParameterError
from ev_sim.benchmark.board import Board, Road


def held_out(board: Board, seed: int) -> Board:
    """A board with the cars that it holds out, its roads with drawn frictions and stiffnesses, and further variations.

    All of it follows from the seed, which is that of the draws as well. ParameterError if it holds nothing out.
    """
    if board.held_out is None:
        raise ParameterError(f"board {board.name} holds nothing out, allowed with an entry held_out")
    random = np.random.Generator(np.random.PCG64(seed))
    of, roads = board.held_out, dict[str, Road]()
    for name, road in board.roads.items():
        friction, stiffness = (low + (high - low) * random.random() for low, high in (of.friction, of.stiffness))
        roads[name] = replace(road, friction=float(friction), stiffness=float(stiffness))
    variations = [*board.variations, *of.variations]
    return replace(board, seed=seed, cars=of.cars, roads=roads, variations=variations)
