"""The runs of a cell: one batch for each law, with the same seeded draws for all of them."""

from __future__ import annotations

import json
import math
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ev_msgs_py.refusal import ParameterError
from ev_stack.scenarios.records import Run
from ev_study.benchmark.board import Board, Cell
from ev_study.benchmark.cell_runs import law_of, law_values, run_of, values_of, with_law
from ev_study.benchmark.draws import drawn, own_draws
from ev_study.benchmark.entry_speed import CLEAN, END, HASH, Driven, at_highest_clean


@dataclass(frozen=True)
class LawInCell:
    """All runs of a law in a cell: as one is configured, what varies, and what is alike in all.

    What varies and what is alike stand by ROLE.PARAMETER.
    """

    run: Run
    vary: Mapping[str, Sequence[Any]]
    fixed: Mapping[str, Any]

    def only(self, draw: int) -> LawInCell:
        """Return one of the runs."""
        return replace(self, vary={name: [column[draw]] for name, column in self.vary.items()})


@dataclass(frozen=True)
class DrivenLaw:
    """Measured on all runs of a law in a cell: by name a number for each draw, NaN without one.

    `clean` is whether a run was, where an entry speed was looked for. `commands` and `hashes` have
    for each draw the line that drives it alone and the signal hash that this line gives, empty
    where a number is not finite.
    """

    metrics: Mapping[str, np.ndarray]
    clean: np.ndarray
    commands: Sequence[str]
    hashes: Sequence[str]


@dataclass(frozen=True)
class DrivenCell:
    """A cell as some laws have driven it."""

    cell: Cell
    laws: Mapping[str, DrivenLaw]

    @property
    def metrics(self) -> dict[str, Mapping[str, np.ndarray]]:
        """Metrics by law."""
        return {law: of.metrics for law, of in self.laws.items()}


def drive_cell(
    board: Board, cell: Cell, laws: Sequence[str], threads: int | None = None
) -> DrivenCell:
    """Drive all draws of a cell with each law; ParameterError for a mistake of the board's file."""
    driven = {}
    for law, runs in laws_in_cell(board, cell, laws).items():
        words, found = drive_law(board, cell, runs, threads)
        driven[law] = DrivenLaw(
            # What the search needs for itself is no metric.
            {name: of for name, of in found.items() if name not in (CLEAN, HASH, END)},
            # Without a search every run counts as clean.
            found.get(CLEAN, np.ones(board.draws)) == 1.0,
            list(map(shlex.join, words)),
            found[HASH].tolist(),
        )
    return DrivenCell(cell, driven)


def drive_law(
    board: Board, cell: Cell, runs: LawInCell, threads: int | None = None
) -> tuple[list[list[str]], Driven]:
    """Drive a law in a cell: what came of it, and the words that drive each run alone.

    They do so over DDS, or with --offline or --in-process behind them another way.
    """
    manoeuvre = board.manoeuvres[cell.manoeuvre]
    speeds, found = at_highest_clean(board, manoeuvre, runs.run, runs.vary, threads)
    words = ["scripts/run.sh", manoeuvre.scenario]
    if manoeuvre.run:
        words += ["--run", manoeuvre.run]
    words += ["--vehicle", cell.car.partition(":")[0], "--duration"]
    # The speeds that were found are fixed in the command, so that it searches nothing.
    columns = {**runs.vary, **speeds}
    commands = []
    for draw, end in enumerate(found[END].tolist()):
        values = {**runs.fixed, **{name: column[draw] for name, column in columns.items()}}
        # A run that ended early has the same hash only if it ends there again.
        command = [*words, repr(manoeuvre.duration if math.isnan(end) else end)]
        for name, value in values.items():
            command += ["--set", f"{name}={json.dumps(value)}"]
        commands.append(command)
    return commands, found


def laws_in_cell(board: Board, cell: Cell, laws: Sequence[str]) -> dict[str, LawInCell]:
    """Return by law its runs in a cell, the same draws for all.

    ParameterError for a mistake of the board's file.
    """
    fixed = values_of(board, cell)
    # The scenario with its own law: what is drawn as a factor is on the values of this run.
    base = run_of(board, cell, fixed)
    draws = drawn(board, cell, base.configurations)
    found = {}
    for law in laws:
        playing = law_of(board, law, base)
        of_law = {}
        for role, values in law_values(board, law, base).items():
            of_law |= {f"{role}.{name}": value for name, value in values.items()}
        run = with_law(base, playing)
        # The configuration of the law takes the place of that of the scenario, and what the
        # manoeuvre sets in it would be lost.
        for name in sorted(fixed.keys() - of_law.keys()):
            if name.partition(".")[0] in playing and _value(run, name) != _value(base, name):
                sets = f"manoeuvre {cell.manoeuvre} sets {name}"
                raise ParameterError(
                    f"{sets}, which law {law} does not take over, expected in the law"
                )
        vary = {**draws.values, **own_draws(playing, draws)}
        found[law] = LawInCell(run, vary, {**fixed, **of_law})
    return found


def _value(run: Run, name: str) -> Any:
    """Value of a ROLE.PARAMETER; None if the role has none of this name."""
    role, _, parameter = name.partition(".")
    return run.configurations[role].values().get(parameter)
