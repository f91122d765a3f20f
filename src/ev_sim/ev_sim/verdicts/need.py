"""What has to be driven for a verdict, and what a verdict gets of it."""

from __future__ import annotations

import argparse
import shlex
from dataclasses import dataclass
from typing import Any, NoReturn

from ev_core.vehicle.description import Vehicle
from ev_msgs_py.refusal import ParameterError, quoted
from ev_sim.command_line.options import add_changes, overrides
from ev_sim.measures.samples import Parameters, Runs
from ev_sim.study.study import Results, study_names

Value = tuple[str, str, Any]  # node, parameter, value


@dataclass(frozen=True, slots=True)
class ScenarioNeed:
    """Runs of a scenario: all of them, or those named, with some parameters (node, name, value) changed.

    `slow` marks what takes more than a few seconds.
    """

    scenario: str
    values: tuple[Value, ...] = ()
    runs: tuple[str, ...] = ()
    duration: float | None = None
    slow: bool = False

    @property
    def command(self) -> str:
        """What drives the same from the command line."""
        changed = [f"--set {node}.{name}={_word(value)}" for node, name, value in self.values]
        duration = [f"--duration {self.duration:g}"] if self.duration else []
        return " ".join([self.scenario, *changed, *duration])


def _word(value: Any) -> str:
    """A value as the command line takes it."""
    if isinstance(value, tuple):
        return f"[{','.join(map(_word, value))}]"
    return str(value).lower() if isinstance(value, bool) else str(value)


@dataclass(frozen=True, slots=True)
class StudyNeed:
    """All cases of a study with some options of its command line; `slow` as above."""

    study: str
    options: tuple[str, ...] = ()
    slow: bool = True

    @property
    def command(self) -> str:
        """What drives the same from the command line."""
        return " ".join([self.study, *self.options])


Need = ScenarioNeed | StudyNeed


def need_of(text: str) -> Need:
    """The need that a text means, which is as on the command line: a scenario, or a study with its options.

    A scenario may have --set, --duration, --runs (those that are driven, all if it is left out) and --slow; a study
    counts as slow unless there is --quick. ParameterError if the text is refused.
    """
    name, *words = shlex.split(text) or [""]
    if name in study_names():
        return StudyNeed(name, tuple(word for word in words if word != "--quick"), slow="--quick" not in words)
    parser = _Parser(add_help=False)
    add_changes(parser)
    parser.add_argument("--runs", nargs="+", default=())
    parser.add_argument("--slow", action="store_true")
    given, unknown = parser.parse_known_args(words)
    if not name or unknown:
        refused = quoted(" ".join(unknown) or text)
        raise ParameterError(
            f"what is driven: {refused} is refused, allowed is a scenario with --set, --duration, --runs"
        )
    found = overrides(given)
    values = tuple((node, name, _frozen(value)) for node, name, value in found.values)
    return ScenarioNeed(name, values, tuple(given.runs), found.duration, given.slow)


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        raise ParameterError(f"what is driven: {message}")


def _frozen(value: Any) -> Any:
    return tuple(map(_frozen, value)) if isinstance(value, list) else value


@dataclass(frozen=True)
class ScenarioRuns:
    """The runs of a scenario by name, their car, and the parameters of the first one."""

    runs: Runs
    vehicle: Vehicle
    parameters: Parameters


@dataclass(frozen=True)
class StudyCases:
    """What a study has measured, and the options that it was given."""

    results: Results
    given: argparse.Namespace


Driven = ScenarioRuns | StudyCases
