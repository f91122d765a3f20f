"""The runs of a cell: one batch for each law, with the same seeded draws for all of them."""

from __future__ import annotations

import json
import math
import shlex
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ev_core.lockstep.configuration import Configuration
from ev_msgs_py.refusal import ParameterError
from ev_stack.scenarios.scenario import Run
from ev_study.benchmark.board import Board, Cell
from ev_study.benchmark.cell_runs import law_of, law_values, run_of, values_of
from ev_study.benchmark.draws import drawn, own_draws
from ev_study.benchmark.entry_speed import CLEAN, END, HASH, Driven, at_highest_clean


@dataclass(frozen=True)
class LawInCell:
    """All runs of a law in a cell: as one is configured, what varies, and by ROLE.PARAMETER what is alike in all."""

    run: Run
    vary: Mapping[str, Sequence[Any]]
    fixed: Mapping[str, Any]

    def only(self, draw: int) -> LawInCell:
        """One of the runs."""
        return replace(self, vary={name: [column[draw]] for name, column in self.vary.items()})


@dataclass(frozen=True)
class DrivenCell:
    """What was measured in a cell: by law and name one number for each draw, NaN where there is none.

    `commands` and `hashes` have by law for each draw the line that drives it alone, and the signal
    hash that this line gives, empty where a number is not finite; `clean` whether it was, where an
    entry speed was looked for.
    """

    cell: Cell
    metrics: dict[str, Mapping[str, np.ndarray]]
    commands: dict[str, Sequence[str]]
    hashes: dict[str, Sequence[str]]
    clean: dict[str, np.ndarray]


def drive_cell(
    board: Board, cell: Cell, laws: Sequence[str], threads: int | None = None
) -> DrivenCell:
    """Drive all draws of a cell with each law; ParameterError for what the file of the board gets wrong."""
    driven = DrivenCell(cell, {}, {}, {}, {})
    for law, runs in laws_in_cell(board, cell, laws).items():
        words, found = drive_law(board, cell, runs, threads)
        driven.metrics[law] = {
            name: of for name, of in found.items() if name not in (CLEAN, HASH, END)
        }
        driven.clean[law] = found.get(CLEAN, np.ones(board.draws)) == 1.0
        driven.commands[law] = list(map(shlex.join, words))
        driven.hashes[law] = found[HASH].tolist()
    return driven


def drive_law(
    board: Board, cell: Cell, runs: LawInCell, threads: int | None = None
) -> tuple[list[list[str]], Driven]:
    """Drive a law in a cell: what came of it, and the words that drive each run alone.

    They do so over DDS, or with --offline or --in-process behind them another way.
    """
    manoeuvre = board.manoeuvres[cell.manoeuvre]
    speeds, found = at_highest_clean(board, manoeuvre, runs.run, runs.vary, threads)
    words = [
        "scripts/run.sh",
        manoeuvre.scenario,
        *(["--run", manoeuvre.run] if manoeuvre.run else []),
    ]
    words += ["--vehicle", cell.car.partition(":")[0], "--duration"]
    commands = []
    for draw, end in enumerate(found[END].tolist()):
        values = {
            **runs.fixed,
            **{name: column[draw] for name, column in {**runs.vary, **speeds}.items()},
        }
        set_to = [
            word
            for name, value in values.items()
            for word in ("--set", f"{name}={json.dumps(value)}")
        ]
        commands.append([*words, repr(manoeuvre.duration if math.isnan(end) else end), *set_to])
    return commands, found


def laws_in_cell(board: Board, cell: Cell, laws: Sequence[str]) -> dict[str, LawInCell]:
    """By law its runs in a cell, the same draws for all; ParameterError for what the file of the board gets wrong."""
    fixed = values_of(board, cell)
    base = run_of(board, cell, fixed)
    draws, found = drawn(board, cell, base.configurations), {}
    for law in laws:
        playing = law_of(board, law, base)
        values = law_values(board, law, base)
        of_law = {
            f"{role}.{name}": value for role, of in values.items() for name, value in of.items()
        }
        _refuse_lost(
            f"manoeuvre {cell.manoeuvre}",
            law,
            fixed.keys() - of_law.keys(),
            base.configurations,
            playing,
        )
        run = replace(base, configurations={**base.configurations, **playing})
        found[law] = LawInCell(
            run, {**draws.values, **own_draws(playing, draws)}, {**fixed, **of_law}
        )
    return found


def _refuse_lost(
    who: str,
    law: str,
    names: Iterable[str],
    run: Mapping[str, Configuration],
    playing: Mapping[str, Configuration],
) -> None:
    """ParameterError if a law does not have what is set for its role by ROLE.PARAMETER in the run without it."""
    for name in sorted(names):
        role, _, parameter = name.partition(".")
        if role in playing and playing[role].values().get(parameter) != run[role].values().get(
            parameter
        ):
            raise ParameterError(
                f"{who} sets {name}, which law {law} does not take over, expected in the law"
            )
