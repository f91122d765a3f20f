"""Studies: their form, those that are offered, and one run among the many of a study.

How it works: a study gives cases; each is resolved to one run, driven offline by a worker, measured
there by the study, and comes back as a `CaseResult` with numbers and small arrays. Signals stay
with the worker. What a law or car forbids is no error of the study but a refused case.
"""

from __future__ import annotations

import argparse
import time
import traceback
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Protocol

from ev_core.methods.offered import offered, offered_module
from ev_core.methods.register import methods_of, node_package
from ev_msgs_py.refusal import ParameterError, unknown_name
from ev_stack.command_line.offered_commands import STUDIES
from ev_stack.command_line.options import overrides
from ev_stack.measures.handling import has_spun
from ev_stack.measures.metric import Metric, NotMeasured, metric
from ev_stack.recording.offline import run_offline, true_motion
from ev_stack.recording.recording import Recording, signal_hash
from ev_stack.running.steering_angles import with_own_angles
from ev_stack.scenarios.records import Overrides, Run, Scenario
from ev_stack.scenarios.scenario import load_scenario

Measure = Callable[[Recording, Run], Mapping[str, Any]]  # of the true motion


@dataclass(frozen=True, slots=True)
class Case:
    """A run of a scenario, and what differs from the scenario's own file.

    `values` are (node, parameter, value).

    `metrics` are measured besides those of the scenario (`measures.expression`).

    A study drives several methods, so some values may be for others than that of this case.

    `run` is needed for a scenario with several runs only.
    """

    name: str
    scenario: str
    values: tuple[tuple[str, str, Any], ...] = ()
    run: str = ""
    files: tuple[Path, ...] = ()
    duration: float | None = None
    vehicle: str | None = None
    metrics: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class CaseResult:
    """Measures of a study on a case.

    `refused` has a line if it cannot be driven or measured. `simulated_time` and `wall_time` [s]
    are those of driving, `notes` what its nodes noted, `spun` whether the car has.
    """

    name: str
    measured: Mapping[str, Any]
    signal_hash: str = ""
    simulated_time: float = 0.0
    wall_time: float = 0.0
    refused: str = ""
    notes: tuple[str, ...] = ()
    spun: bool = False


def drive_case(case: Case, measure: Measure) -> CaseResult:
    """Drive a case offline and measure it; nothing else is kept of its signals than their hash.

    A case that its parameters, a law on this vehicle, or a signal that is not finite forbid comes
    back as refused, and so does one that is driven, with its hash, and cannot be measured. OSError
    if its signals cannot be written.
    """
    try:
        scenario = scenario_of(case)
        own = with_own_angles(scenario)
        # Exactly one run: `scenario_of` refuses more.
        (run,) = own.runs
        # Which values of a file a case leaves unused is no news; which angles it drives is.
        notes = list(own.notes[len(scenario.notes) :])
        start = time.monotonic()
        recording = run_offline(
            run.configurations,
            run.duration,
            note=lambda role, text: notes.append(f"{role}: {text}"),
        )
    # a ParameterError or SignalError, or the refusal of a vehicle by a law
    except ValueError as error:
        return CaseResult(case.name, {}, refused=str(error))
    wall_time = time.monotonic() - start
    # The hash is there even if measuring fails: what was driven can still be compared.
    driven = CaseResult(
        case.name,
        {},
        signal_hash(recording),
        run.duration,
        wall_time,
        "",
        tuple(dict.fromkeys(notes)),
    )
    try:
        motion = true_motion(recording, run.configurations)
        driven = replace(driven, spun=has_spun(motion))
        return replace(driven, measured=measure(motion, run))
    # A full disk is no property of the case.
    except OSError:
        raise
    except NotMeasured as why:
        return replace(driven, refused=str(why))
    # a run too short, or another than was thought of: the other cases are measured
    except Exception as error:
        last = traceback.extract_tb(error.__traceback__)[-1]
        # One line with type and place: a traceback for each of many cases would bury the table.
        cause = " ".join(f"{type(error).__name__} {error}".split())
        return replace(driven, refused=f"{cause} ({Path(last.filename).name}, line {last.lineno})")


def scenario_of(case: Case) -> Scenario:
    """The scenario of a case with its only run.

    Raises ParameterError, in one line, if something is refused.
    """
    overrides = Overrides(
        case.files, (), case.duration, case.vehicle, prepared=case.values, metrics=case.metrics
    )
    scenario = load_scenario(case.scenario, overrides, only=(case.run,) if case.run else ())
    # A case of several runs would have several results.
    if len(scenario.runs) > 1:
        names = [run.name for run in scenario.runs]
        raise unknown_name(f"run of {case.scenario}", case.run, names)
    return scenario


def run_of(case: Case) -> Run:
    """The run of a case as it is resolved, before a slow ramp that it may need."""
    return scenario_of(case).runs[0]


def run_of_command(given: argparse.Namespace) -> Run:
    """The run that a command names by its scenario and --run, the first if it names none, with what it changes.

    As it is in the scenario's file if the change does not fit it: that of a case may fit then.
    """
    changed, runs = overrides(given), load_scenario(given.scenario).runs
    # Whether it fits a case is found out when that case is made.
    with suppress(ParameterError):
        prepared = Overrides(
            changed.files, (), changed.duration, changed.vehicle, changed.all_values
        )
        runs = load_scenario(given.scenario, prepared).runs
    names = [run.name for run in runs]
    if given.run and given.run not in names:
        raise unknown_name(f"run of {given.scenario}", given.run, names)
    return runs[names.index(given.run) if given.run else 0]


Results = Mapping[str, CaseResult]  # name of the case -> what came out


class Study(Protocol):
    """A module that gives the cases to drive, what to measure on each, and the metrics of all of them together."""

    ABOUT: str  # one line for --list

    def cases(self, given: argparse.Namespace) -> Sequence[Case]:
        """The cases, each with a name of its own; ParameterError if an option is refused."""

    def measure(self, recording: Recording, run: Run) -> Mapping[str, Any]:
        """Numbers and small arrays, by name; called by the worker that has driven the case."""

    def metrics(self, given: argparse.Namespace, results: Results) -> dict[str, Metric]:
        """Metrics by name, in the order of the table."""

    COLUMNS: tuple[str, ...]  # of `rows`

    def rows(self, given: argparse.Namespace, results: Results) -> Sequence[tuple[str, ...]]:
        """The table that a page of the documentation shows."""

    # A study may also have
    #
    # - `add_options(parser)`, which declares its options beyond those of all studies,
    # - `SUMS`, with which the metrics begin that sum the rows up,
    # - `figures(given, results)`, by the name of their file without suffix,
    # - `tables(given, results)`, the text that is printed above the metrics; without it these are
    #   its rows below COLUMNS, of which the first LEFT ones are set to the left, below a line
    #   HEADING if there is one,
    # - `table(given, results)`, a Table (`ev_stack.report.tables`) that is kept in files,
    # - `variations(given)`, by NODE.PARAM the values that it varies itself,
    # - `SHORTEST`, the least simulated time with which there is anything to measure [s].


def metrics_of_cases(results: Results, units: Mapping[str, str]) -> dict[str, Metric]:
    """Each of some quantities, by unit, that were measured on each case."""
    return {
        f"{quantity} {name}": metric(
            # Defaults, since a closure would see the last turn of the loops.
            lambda measured=result.measured, quantity=quantity: measured[quantity],
            unit,
        )
        for name, result in results.items()
        for quantity, unit in units.items()
    }


def rows_of_cases(results: Results, forms: Mapping[str, str]) -> list[tuple[str, ...]]:
    """A row for each case: the parts of its name, which `: ` separates, and some quantities, each in its form.

    A dash stands for what a case has no number for.
    """
    rows = []
    for name, result in results.items():
        numbers = ((result.measured.get(quantity), form) for quantity, form in forms.items())
        rows.append(
            (
                *name.split(": "),
                *("–" if value is None else format(value, form) for value, form in numbers),
            )
        )
    return rows


def own_methods(role: str) -> list[str]:
    """The methods of the package that brings the node of a role."""
    return [
        name for name, method in methods_of(role).items() if method.package == node_package(role)
    ]


def study_names() -> list[str]:
    """The names of all installed studies."""
    return sorted(offered(STUDIES))


def study_named(name: str) -> Study:
    """The module of a study; ParameterError that lists the known ones if there is none."""
    return offered_module(STUDIES, "study", name)
