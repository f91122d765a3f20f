"""What has to be driven for a verdict, and what a verdict gets of it."""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from typing import Any

from ev_core.vehicle.description import Vehicle
from ev_sim.measures.samples import Parameters, Runs
from ev_sim.study.study import Results

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
