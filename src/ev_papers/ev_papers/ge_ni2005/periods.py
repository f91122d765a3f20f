"""Chatter of the torques of Ge & Ni (2005) by control period, with the layer of eqs 9 and 10."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from typing import Any

from ev_papers.ge_ni2005.quantities import chatter
from ev_stack.measures.metric import Metric, metric
from ev_stack.recording.recording import Recording
from ev_stack.scenarios.records import Run
from ev_study.studies.study import Case, Results

ABOUT = (
    "Ge & Ni 2005: chatter of the torques with boundary layer by control period, "
    "for two readings of eq 8"
)
SCENARIO = "ge_ni2005"
PERIODS = (0.0005, 0.001, 0.005, 0.01)  # [s]
COMPARED = ("increment", "offset_lower_target")  # runs with slips that come to their target
COLUMNS = ("control period [ms]", *(f"chatter of `{run}` [N m/s]" for run in COMPARED))
LEFT = 0


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Every run at every period, as on the page docs/ge_ni2005.md."""
    found = []
    for period in PERIODS:
        for run in COMPARED:
            values = (("*", "control_period", period),)
            found.append(Case(name_of(run, period), SCENARIO, values, run))
    return found


def name_of(run: str, period: float) -> str:
    """Name of a case; period [s]."""
    return f"{run} {1e3 * period:g} ms"


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """Chatter over the last second [N m/s]."""
    return {"chatter": chatter(recording)}


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """Largest chatter of each run over all periods."""

    def largest(run: str) -> float:
        return max(_chatter(results, run, period) for period in PERIODS)

    return {f"chatter_{run}": metric(lambda run=run: largest(run), "N m/s") for run in COMPARED}


def rows(given: argparse.Namespace, results: Results) -> Sequence[tuple[str, ...]]:
    """One row for each period."""
    found = []
    for period in PERIODS:
        numbers = (f"{_chatter(results, run, period):.3g}" for run in COMPARED)
        found.append((f"{1e3 * period:g}", *numbers))
    return found


def _chatter(results: Results, run: str, period: float) -> float:
    return float(results[name_of(run, period)].measured["chatter"])
