"""One run among the many of a study."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ev_msgs_py.parameters.values import unknown_name
from ev_sim.running.recording.recording import Recording, signal_hash
from ev_sim.running.recording.truth import true_motion
from ev_sim.running.scenarios.scenario import Overrides, Run, load_scenario

Measure = Callable[[Recording, Run], Mapping[str, Any]]  # of the true motion


@dataclass(frozen=True, slots=True)
class Case:
    """A run of a scenario, and what differs from the scenario's own file; `values` are (node, parameter, value).

    `run` is needed for a scenario with several runs only.
    """

    name: str
    scenario: str
    values: tuple[tuple[str, str, Any], ...] = ()
    run: str = ""
    files: tuple[Path, ...] = ()
    duration: float | None = None
    vehicle: str | None = None


@dataclass(frozen=True, slots=True)
class CaseResult:
    """What a study has measured on a case, or in `refused` one line on why the case cannot be driven.

    `simulated_time` and `wall_time` [s] are those of driving, `notes` what its nodes noted.
    """

    name: str
    measured: Mapping[str, Any]
    signal_hash: str = ""
    simulated_time: float = 0.0
    wall_time: float = 0.0
    refused: str = ""
    notes: tuple[str, ...] = ()


def drive_case(case: Case, measure: Measure) -> CaseResult:
    """Drive a case offline and measure it; nothing else is kept of its signals than their hash.

    A case that its parameters, a law on this vehicle, or a signal that is not finite forbid comes back as refused.
    """
    from ev_sim.running.offline import run_offline  # numba is slow to import, and a list of studies drives nothing

    try:
        run = run_of(case)
        start = time.monotonic()
        notes: list[str] = []
        recording = run_offline(
            run.configurations, run.duration, note=lambda role, text: notes.append(f"{role}: {text}")
        )
    except ValueError as error:  # a ParameterError or SignalError, or what a law says to its vehicle
        return CaseResult(case.name, {}, refused=str(error))
    wall_time = time.monotonic() - start
    measured = measure(true_motion(recording, run.configurations), run)
    return CaseResult(
        case.name, measured, signal_hash(recording), run.duration, wall_time, notes=tuple(dict.fromkeys(notes))
    )


def run_of(case: Case) -> Run:
    """The configured graph of a case; ParameterError, in one line, if something in it is refused."""
    overrides = Overrides(case.files, case.values, case.duration, case.vehicle)
    scenario = load_scenario(case.scenario, overrides, only=(case.run,) if case.run else ())
    if len(scenario.runs) > 1:
        raise unknown_name(f"run of {case.scenario}", case.run, [run.name for run in scenario.runs])
    return scenario.runs[0]
