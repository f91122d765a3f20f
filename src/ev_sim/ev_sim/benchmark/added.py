"""Laws that the command line puts beside those of a board: a file of code, or a law with a file of parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from ev_core.check.method import ContractError, check_configuration
from ev_core.lockstep.configuration import refuse_unused
from ev_core.lockstep.finding import is_code
from ev_msgs_py.refusal import ParameterError, quoted
from ev_sim.benchmark.board import Board
from ev_sim.benchmark.driving import ROLE, law_of, run_of, values_of
from ev_sim.scenarios.about import NAMESPACE
from ev_sim.scenarios.parameter_file import ParameterFile

STEPS = 100  # of each check of the contract, for each car of the board


def with_added(board: Board, words: Sequence[str]) -> tuple[Board, list[str]]:
    """A board with further laws, each LAW or LAW=PARAMETERS.yaml, and their names.

    LAW is the path of a law file, a law of the board or the name of a method. ParameterError if a name is taken, or for
    a file without parameters of the electronic differential.
    """
    laws = dict(board.laws)
    for word in words:
        law, _, file = word.partition("=")
        code, _, chosen = law.partition(":")
        name = Path(file).stem if file else chosen or (Path(code).stem if is_code(law) else law)
        if name in laws:
            raise ParameterError(f"--add {quoted(word)}: the board has a law {quoted(name)}, allowed is another name")
        laws[name] = {**board.laws.get(law, {"method": law}), **(_parameters(file) if file else {})}
    return replace(board, laws=laws), [name for name in laws if name not in board.laws]


def _parameters(file: str) -> dict[str, object]:
    found = ParameterFile(Path(file)).values_for(f"{NAMESPACE}/{ROLE}")
    if not found:
        raise ParameterError(f"{file}: no parameters of {ROLE}, allowed is a section /**/{ROLE}")
    return found


def check_laws(board: Board, names: Sequence[str]) -> None:
    """Hold laws against the contract, for each car of the board; ParameterError, in one line, for what breaks it."""
    some = {cell.car: cell for cell in board.cells()}
    for name in names:
        for car, cell in some.items():
            configuration = law_of(board, name, run_of(board, cell, values_of(board, cell)).configurations[ROLE])
            for each in board.laws[name]:
                if each != "method":
                    refuse_unused(each, [configuration])
            law = configuration.method.law
            if law is None or not law.is_compilable:
                raise ParameterError(f"law {name} runs in plain Python, allowed on a board are laws that run compiled")
            try:
                check_configuration(configuration, steps=STEPS)
            except ContractError as error:
                raise ParameterError(f"law {name} with {car}: {'; '.join(error.findings)}") from None
