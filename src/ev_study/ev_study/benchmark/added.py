"""Laws that the command line puts beside those of a board, and what of both is refused before anything is driven."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from ev_core.check.method import ContractError, check_configuration
from ev_core.lockstep.configuration import Configuration, refuse_unused
from ev_core.lockstep.finding import find_method, is_code
from ev_core.parameters.declaration import flatten
from ev_core.parameters.values import check
from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.refusal import ParameterError, quoted
from ev_stack.batches.by_period import PERIOD
from ev_stack.batches.variation import EVERY_ROLE
from ev_stack.batches.variation import Variation as VariedRuns
from ev_stack.scenarios.about import NAMESPACE
from ev_stack.scenarios.files import configured_file
from ev_stack.scenarios.parameter_file import ParameterFile
from ev_stack.scenarios.records import Run
from ev_study.benchmark.board import (
    FRICTION,
    FURTHER,
    MOTOR_FAULT,
    ROLE,
    TOLD_FRICTION,
    Board,
    Variation,
    by_role,
)
from ev_study.benchmark.cell_runs import law_of, run_of, values_of
from ev_study.benchmark.draws import BELIEF, value_in

STEPS = 100  # of each check of the contract, for each car of the board


def with_added(board: Board, words: Sequence[str]) -> tuple[Board, list[str]]:
    """A board with further laws, each LAW or LAW=PARAMETERS.yaml, and their names.

    LAW is the path of a law file, a law of the board or the name of a method; one of another role
    than the electronic differential drives with the reference of the board. ParameterError if a
    name is taken, or for a file without parameters of a law.
    """
    laws = dict(board.laws)
    for word in words:
        law, _, file = word.partition("=")
        code, _, chosen = law.partition(":")
        name = Path(file).stem if file else chosen or (Path(code).stem if is_code(law) else law)
        if name in laws:
            raise ParameterError(
                f"--add {quoted(word)}: the board has a law {quoted(name)}, expected another name"
            )
        laws[name] = {
            **(board.laws.get(law) or _with_method(board, law)),
            **(_parameters(file) if file else {}),
        }
    return replace(board, laws=laws), [name for name in laws if name not in board.laws]


def _with_method(board: Board, law: str) -> Mapping[str, Any]:
    # The first role that knows the name has it: a differential goes before a traction control.
    for role in (ROLE, *FURTHER):
        try:
            find_method(role, law)
        except ParameterError:
            continue
        return (
            {"method": law}
            if role == ROLE
            else {**board.laws[board.reference], f"{role}.method": law}
        )
    return {"method": law}  # is refused where it is configured


def _parameters(file: str) -> dict[str, Any]:
    content = ParameterFile(Path(file))
    found = content.values_for(f"{NAMESPACE}/{ROLE}")
    for role in FURTHER:
        of_role = content.values_for(f"{NAMESPACE}/{role}", by_name=True)
        found |= {f"{role}.{name}": value for name, value in of_role.items()}
    if not found:
        sections = " or ".join(f"/**/{role}" for role in (ROLE, *FURTHER))
        raise ParameterError(f"{file}: no parameters of a law, expected a section {sections}")
    return found


def check_laws(board: Board, laws: Sequence[str], added: Sequence[str]) -> None:
    """Configure laws for each car of the board, and hold what was added against the contract.

    Raises ParameterError, in one line, for what is refused or breaks it.
    """
    cells = sorted(board.cells(), key=lambda cell: not board.manoeuvres[cell.manoeuvre].steering_on)
    # the last ones need no run for the steering angles
    for car, cell in {cell.car: cell for cell in cells}.items():
        run = run_of(board, cell, values_of(board, cell))
        for name in laws:
            for role, configuration in law_of(board, name, run).items():
                refuse_unused(by_role(board.laws[name])[role], [configuration])
                if name in added:
                    _hold_against_contract(name, car, configuration)


def _hold_against_contract(name: str, car: str, configuration: Configuration) -> None:
    law = configuration.method.law
    # Batches drive compiled laws alone.
    if law is None or not law.is_compilable:
        raise ParameterError(
            f"law {name} runs in plain Python, expected on a board are laws that run compiled"
        )
    try:
        check_configuration(configuration, steps=STEPS)
    except ContractError as error:
        raise ParameterError(f"law {name} with {car}: {'; '.join(error.findings)}") from None


def refuse_variations(board: Board, runs: Sequence[Run]) -> None:
    """ParameterError, with the board's file, for a variation that does not fit one of some runs."""
    for each, run in itertools.product(board.variations, runs):
        if each.parameter in (FRICTION, TOLD_FRICTION, MOTOR_FAULT):
            continue
        kind = next(kind for kind in ("factor", "value", "count", "choice") if getattr(each, kind))
        try:
            _refuse_variation(each, run.configurations)
        except ParameterError as error:
            file, what = configured_file("benchmark", board.name), f"variation of {each.parameter}"
            raise ParameterError(
                f"{file}: {what} by {kind} {getattr(each, kind)}: {error}"
            ) from None


def _refuse_variation(variation: Variation, driven: Mapping[str, Configuration]) -> None:
    role, _, parameter = variation.parameter.partition(".")
    if variation.parameter != PERIOD:
        VariedRuns(driven, {variation.parameter: [None]}, {})  # the names alone
    if role in (ROLE, *FURTHER) and parameter in flatten(driven[role].parameters):
        # Both would change what a law believes of the friction, and only one of them would be seen.
        if parameter in BELIEF:
            raise ParameterError(
                f"it is what a law believes of the friction, expected {TOLD_FRICTION}"
            )
        if variation.factor:
            raise ParameterError(
                "it is a number of a law, of which each has its own, expected value, count or"
                " choice"
            )
    of_car = value_in(driven, variation.parameter) if variation.factor else 1.0
    declared = {
        each.name: each for each in driven[MASTER if role == EVERY_ROLE else role].entries()
    }[parameter]
    for end in (
        variation.choice or variation.count or [of_car * float(each) for each in variation.bounds]
    ):
        check(declared, end)  # whether it fits the other values is known with all that is drawn
