"""What a study is, and which ones there are."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from typing import Any, Protocol

from ev_core.methods.offered import offered, offered_module
from ev_sim.figures.figure import Figure
from ev_sim.measures.metric import Metric
from ev_sim.recording.recording import Recording
from ev_sim.scenarios.scenario import Run
from ev_sim.study.case import Case, CaseResult

GROUP = "ev_stack.studies"  # of entry points: the name of a study, and its module

Results = Mapping[str, CaseResult]  # name of the case -> what came out


class Study(Protocol):
    """A module that says which cases to drive, what to measure on each, and what all of them say together."""

    ABOUT: str  # one line for --list

    def add_options(self, parser: argparse.ArgumentParser) -> None:
        """Declare the options that this study has beyond those of all studies."""

    def cases(self, given: argparse.Namespace) -> Sequence[Case]:
        """The cases, each with a name of its own; ParameterError if an option is refused."""

    def measure(self, recording: Recording, run: Run) -> Mapping[str, Any]:
        """Numbers and small arrays, by name; called by the worker that has driven the case."""

    def metrics(self, given: argparse.Namespace, results: Results) -> dict[str, Metric]:
        """Metrics by name, in the order of the table."""

    COLUMNS: tuple[str, ...]  # of `rows`
    SUMS: tuple[str, ...]  # with which the metrics begin that sum the rows up

    def rows(self, given: argparse.Namespace, results: Results) -> Sequence[tuple[str, ...]]:
        """The table that a page of the documentation shows."""

    def tables(self, given: argparse.Namespace, results: Results) -> str:
        """What is printed above the metrics, as aligned text; may be empty."""

    # A study may also have `table(given, results)`, whose columns and rows of values are kept as files, and `SHORTEST`,
    # the least simulated time with which there is anything to measure [s].

    def figures(self, given: argparse.Namespace, results: Results) -> dict[str, Figure]:
        """Figures by the name of their file without suffix."""


def study_names() -> list[str]:
    """The names of all installed studies."""
    return sorted(offered(GROUP))


def study_named(name: str) -> Study:
    """The module of a study; ParameterError that lists the known ones if there is none."""
    return offered_module(GROUP, "study", name)
