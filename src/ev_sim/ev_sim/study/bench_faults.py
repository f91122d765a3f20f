"""Every fault of the bench and its bus, seeded, in the loop: how soon the torque is gone, and what brings it back."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from typing import Any

from ev_msgs_py.parameters.declaration import ParameterError
from ev_sim.report.figures.figure import Figure
from ev_sim.report.metric import Metric, metric
from ev_sim.report.text_table import text_table
from ev_sim.running.recording.recording import Recording
from ev_sim.running.scenarios.scenario import Run
from ev_sim.study import bench_fault_trial
from ev_sim.study.bench_fault_trial import CYCLE, END, FAULTS, LATEST, trial
from ev_sim.study.case import Case, CaseResult
from ev_sim.study.study import Results

ABOUT = "Faults of bus, inverters and bench in the loop: zero torque in time, latched, named, reset (--seeds N)"
SEEDS = 100
TIMEOUT = 0.010  # s, of set-points, of feedback, and of what cannot be
COLUMNS = ("fault", "passed", "that drive without torque after", "the other one", "on the bus and in the diagnosis")
SUMS = ("passed", "latest")
SHORTEST = LATEST + END
_HALF_STEP = 1e-6  # s, by which sums of periods may be off
_DERATED = (20.0, 45.0)  # N m: a tenth of 360 N m is left at 138 degC, and 61 to 122 were asked for


def add_options(parser: argparse.ArgumentParser) -> None:
    """How many trials each fault gets."""
    parser.add_argument("--seeds", type=int, default=SEEDS, metavar="N", help=f"trials of each fault, default {SEEDS}")


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Every fault with every seed."""
    if given.seeds < 1:
        raise ParameterError(f"--seeds: {given.seeds} is refused, allowed is 1 and more")
    return [trial(what, seed) for what in FAULTS for seed in range(given.seeds)]


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """See `bench_fault_trial.measure`."""
    return bench_fault_trial.measure(recording, run)


def wrong(what: str, result: CaseResult) -> str:
    """What went wrong in a trial, in a few words; empty if nothing did."""
    if result.refused:
        return result.refused
    found, fault, limit = result.measured, FAULTS[what], TIMEOUT + CYCLE + _HALF_STEP
    if not fault.named:
        derated = _DERATED[0] < found["least"] < _DERATED[1]
        return "" if derated and found["named"] == ["Derating", "Warm"] and found["back"] else "it did not just derate"
    checks = {
        "torque too late gone": found["gone_after"] <= limit,
        "not named on the bus": fault.named in found["named"],
        "not named in the diagnosis": any(note.endswith(f"drive: {fault.named}") for note in result.notes),
        "not latched": found["latched"],
        "the other drive": found["other_gone_after"] <= limit if fault.both else found["other_kept"],
        "not back after the reset": found["back"],
    }
    return ", ".join(text for text, good in checks.items() if not good)


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """How many trials passed, and the latest zero torque of all faults that take the torque away."""
    latest = [found for what in FAULTS if FAULTS[what].named for found in _all(given, results, what)]
    passed = sum(not wrong(what, r) for what in FAULTS for r in _all(given, results, what))
    return {
        "passed": metric(lambda: float(passed), "1"),
        "trials": metric(lambda: float(len(results)), "1"),
        "latest_zero_torque": metric(lambda: max(r.measured["gone_after"] for r in latest), "s"),
    }


def rows(given: argparse.Namespace, results: Results) -> Sequence[tuple[str, ...]]:
    """One row for each fault."""
    return [_row(given, results, what) for what in FAULTS]


def tables(given: argparse.Namespace, results: Results) -> str:
    """The same as aligned text, and what went wrong."""
    failures = sorted({f"{what}: {w}" for what in FAULTS for r in _all(given, results, what) if (w := wrong(what, r))})
    return "\n".join([text_table(COLUMNS, rows(given, results), left=(0, 4)), *failures])


def figures(given: argparse.Namespace, results: Results) -> dict[str, Figure]:
    """None: the table says it all."""
    return {}


def _all(given: argparse.Namespace, results: Results, what: str) -> list[CaseResult]:
    return [results[f"{what} {seed}"] for seed in range(given.seeds)]


def _row(given: argparse.Namespace, results: Results, what: str) -> tuple[str, ...]:
    found, fault = _all(given, results, what), FAULTS[what]
    passed = sum(not wrong(what, result) for result in found)
    driven = [result.measured for result in found if not result.refused]
    gone = _times([m["gone_after"] for m in driven]) if fault.named else "keeps a tenth"
    other = _times([m["other_gone_after"] for m in driven]) if fault.both else "keeps its torque"
    return what, f"{passed} of {len(found)}", gone, other, fault.named or "Derating"


def _times(times: list[float]) -> str:
    return f"{1e3 * min(times):.0f} to {1e3 * max(times):.0f} ms" if times else "-"
