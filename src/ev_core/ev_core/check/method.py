"""Holding a method against the contract: all checks, and one error that lists what they found."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from ev_core.check import state
from ev_core.check.demand import ignored_demand
from ev_core.check.mirror import asymmetry
from ev_core.check.ranges import out_of_range
from ev_core.check.reached import Reached, inexact, reached
from ev_core.check.stepping import MakesInputs, RandomInputs, Subject
from ev_core.lockstep.configuration import Configuration, configure, refuse_unused

SEEDS = (1, 2)
STEPS = 200


class ContractError(AssertionError):
    """A method breaks the contract; the message lists all `findings`, one per line."""

    def __init__(self, method: str, findings: Sequence[str]) -> None:
        self.findings = tuple(findings)
        super().__init__(
            "\n".join([f"{method} breaks the contract:", *(f"- {finding}" for finding in findings)])
        )


def check_method(
    role: str,
    name: str,
    values: Mapping[str, Any] | None = None,
    *,
    seeds: Sequence[int] = SEEDS,
    steps: int = STEPS,
    inputs: MakesInputs = RandomInputs,
    mirrored: bool = True,
    whole: bool = True,
) -> Reached:
    """Hold a registered method, with these parameter values, against the contract.

    ContractError lists the findings. It has to be exact (`inexact`), pure and deterministic, finite
    or refused, and the same to the bit after it was saved and loaded, after a parameter was set to
    its own value, and compiled if it is marked so. Its torques have to depend on what the driver
    drives and brakes (`ignored_demand`). No index of a law may leave its row where one parameter is
    at an end of its range (`out_of_range`). If it claims mirror symmetry it is held to that, unless
    `mirrored` is false, for values that are an exception. For each seed it is stepped so many times
    with what `inputs` makes: random numbers and launches, by default. The answer says how often its
    lines were reached in plain Python; a function of its module that was never called is a finding,
    unless `whole` is false, for values that leave some out.
    """
    configuration = configure(role, {"method": name, **(values or {})})
    refuse_unused(values or {}, [configuration])
    return check_configuration(
        configuration, seeds=seeds, steps=steps, inputs=inputs, mirrored=mirrored, whole=whole
    )


def check_configuration(
    configuration: Configuration,
    *,
    seeds: Sequence[int] = SEEDS,
    steps: int = STEPS,
    inputs: MakesInputs = RandomInputs,
    mirrored: bool = True,
    whole: bool = False,
) -> Reached:
    """Hold a configured method, such as that of a scenario, against the contract."""
    mirrored = mirrored and configuration.method.mirrored
    found = list(_findings(configuration, seeds, steps, inputs, mirrored))
    lines = Reached({}, {})
    if not found:
        lines = reached(Subject(configuration, _is_heavy(configuration), steps, inputs), seeds)
    if whole and lines.never_called:
        never = ", ".join(lines.never_called)
        found.append(f"in {steps} steps for each of {len(seeds)} seeds never called: {never}")
    if found:
        raise ContractError(f"{configuration.role} method {configuration.method.name}", found)
    return lines


def _is_heavy(configuration: Configuration) -> bool:
    law = configuration.method.law
    return law is not None and law.heavy


def _findings(
    configuration: Configuration,
    seeds: Sequence[int],
    steps: int,
    inputs: MakesInputs,
    mirrored: bool,
) -> Iterator[str]:
    if found_inexact := inexact(configuration.method):
        yield found_inexact
    law = configuration.method.law
    can_compile = law is not None and law.is_compilable
    # A heavy law would take minutes in plain Python.
    forms = (False, True) if can_compile and not _is_heavy(configuration) else (can_compile,)
    for compiled in forms:
        subject = Subject(configuration, compiled, steps, inputs)
        found = list(_of(subject, seeds, mirrored))
        yield from found
        # Findings of plain Python need not be repeated, and compiled code would fail less gently.
        if found:
            return
    if law is not None and not _is_heavy(configuration):
        beyond = out_of_range(configuration, seeds[0], inputs)
        if beyond:
            yield beyond
    if can_compile:
        differs = _first(state.differing_bits(configuration, steps, seed, inputs) for seed in seeds)
        if differs:
            yield f"compiled and interpreted differ, {differs}"


def _of(subject: Subject, seeds: Sequence[int], mirrored: bool) -> Iterator[str]:
    """Findings about one form of a method, one alone if it cannot be stepped at all."""
    checks = [
        state.impurity,
        state.lost_state,
        state.lost_by_live_change,
        state.not_refused,
        ignored_demand,
        *([asymmetry] if mirrored else []),
    ]
    for seed in seeds:
        stumbles = state.not_finite(subject, seed)
        if stumbles:
            yield f"{subject.form}, {stumbles} (seed {seed})"
            return
    unnamed = state.unnamed_state(subject)
    if unnamed:
        yield unnamed
    elif resized := state.resized_by_live_change(subject):
        yield f"{subject.form}, {resized}"
    for check in checks:
        found = _first(check(subject, seed) for seed in seeds)
        if found:
            yield f"{subject.form}, {found}"


def _first(found: Iterable[str]) -> str:
    """The first of these texts that is not empty; empty if all are."""
    return next(filter(None, found), "")
