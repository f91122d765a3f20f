"""Variations between the runs of a cell: seeded draws, the same for all laws.

How it works: one generator for each cell, with the seed of the board and the name of the cell,
gives all numbers in the order of the variations. So draws do not depend on laws, on other cells or
on which of them are driven, and all laws meet the same ones.
"""

from __future__ import annotations

import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ev_core.lockstep.configuration import Configuration
from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.refusal import ParameterError
from ev_stack.batches.variation import EVERY_ROLE
from ev_study.benchmark.board import FRICTION, MOTOR_FAULT, TOLD_FRICTION, Board, Cell, Variation
from ev_study.benchmark.cell_runs import SEEDS, driven_wheels, surfaces_of

# how laws call the friction that they believe in over the true one
BELIEF = ("known.error_factor", "error_factor")
_FAULTS, _ANYTHING = "faults", 2**31


@dataclass(frozen=True)
class Draws:
    """Values of each run for all laws, by ROLE.PARAMETER.

    `believed` scales the friction that the laws assume.
    """

    values: Mapping[str, Sequence[Any]]
    believed: Sequence[float]


def numbers_drawn(board: Board, cell: Cell) -> tuple[list[int], dict[str, list[Any]]]:
    """The seed of each run, and by variation what is drawn for it, by the seed of the board and the name of the cell.

    That is a factor, a value, a whole number or a choice; of MOTOR_FAULT the text of the fault,
    empty without one.
    """
    # crc32, since Python's own hash of a text differs from process to process.
    random = np.random.Generator(np.random.PCG64([board.seed, zlib.crc32(cell.id("").encode())]))
    seeds, found = random.integers(_ANYTHING, size=board.draws).tolist(), {}
    for variation in board.variations:
        # Of a choice the bounds are 0 and 1, and the numbers drawn by them are not used.
        low, high = variation.bounds
        numbers: list[Any] = (low + (high - low) * random.random(board.draws)).tolist()
        if variation.parameter == MOTOR_FAULT:
            numbers = _motor_faults(variation, driven_wheels(board, cell), numbers, random)
        elif variation.choice:
            chosen = random.integers(len(variation.choice), size=board.draws).tolist()
            numbers = [variation.choice[each] for each in chosen]
        elif variation.count:
            numbers = random.integers(int(low), int(high) + 1, size=board.draws).tolist()
        found[variation.parameter] = numbers
    return seeds, found


def _motor_faults(
    variation: Variation,
    wheels: Sequence[str],
    shares: Sequence[float],
    random: np.random.Generator,
) -> list[str]:
    """The fault of each run: none, or that of the motor of one of some wheels."""
    # Drawn for all runs, struck or not: the numbers behind them stay the same for any probability.
    struck = random.random(len(shares)) < variation.probability
    places = random.integers(len(wheels), size=len(shares))
    low, high = variation.begin
    begins = low + (high - low) * random.random(len(shares))
    return [
        f"motor_share {wheels[place]} {share:.3f} from {begin:.2f}" if is_struck else ""
        for is_struck, place, share, begin in zip(struck, places, shares, begins, strict=True)
    ]


def drawn(board: Board, cell: Cell, base: Mapping[str, Configuration]) -> Draws:
    """The draws of a cell for its run without a law."""
    seeds, numbers = numbers_drawn(board, cell)
    values: dict[str, list[Any]] = {SEEDS: seeds}
    believed = [1.0] * board.draws
    for variation in board.variations:
        found = numbers[variation.parameter]
        # No parameter of the car: it changes what the laws are given (`own_draws`).
        if variation.parameter == TOLD_FRICTION:
            believed = found
        elif variation.parameter == FRICTION:
            surfaces = [surfaces_of(board, cell, factor) for factor in found]
            # Both are frictions; c2 is where over the slip the largest one lies.
            for name in ("own_c1", "own_c3"):
                values[f"{MASTER}.road.{name}"] = [each[name] for each in surfaces]
        elif variation.parameter == MOTOR_FAULT:
            of_run = base[MASTER].values()[_FAULTS]
            values[f"{MASTER}.{_FAULTS}"] = [
                # A fault of the manoeuvre itself stays.
                [*of_run, fault] if fault else of_run
                for fault in found
            ]
        elif variation.factor:
            of_car = value_in(base, variation.parameter)
            values[variation.parameter] = [of_car * factor for factor in found]
        else:
            values[variation.parameter] = found
    return Draws(values, believed)


def value_in(base: Mapping[str, Configuration], name: str) -> float:
    """Return the value that a variation by a factor is on; ParameterError if it is no number."""
    role, _, parameter = name.partition(".")
    known = (
        base[MASTER if role == EVERY_ROLE else role].values()
        if role == EVERY_ROLE or role in base
        else {}
    )
    if not isinstance(known.get(parameter), float):
        raise ParameterError(
            f"{name} is refused: nothing of this name has a number that a factor could change"
        )
    return float(known[parameter])


def own_draws(law: Mapping[str, Configuration], draws: Draws) -> dict[str, Sequence[float]]:
    """Draw the friction that a law believes in, by its own names: its own factor x believed.

    Raises ParameterError if one of the products is beyond the bounds of that name.
    """
    return {
        f"{role}.{name}": [own * believed for believed in draws.believed]
        for role, of in law.items()
        for name, own in of.values().items()
        if name in BELIEF
    }
