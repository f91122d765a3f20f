"""Batches of runs with different control periods: one batch for each period."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ev_core.lockstep.configuration import Configuration
from ev_stack.batches.batch import BatchResult, batch
from ev_stack.batches.variation import EVERY_ROLE
from ev_stack.batches.whole_runs import Ending
from ev_stack.measures.named import NamedMetric

_PERIOD = "control_period"
PERIOD = f"{EVERY_ROLE}.{_PERIOD}"


def batch_by_period(
    configurations: Mapping[str, Configuration],
    duration: float,
    vary: Mapping[str, Sequence[Any]],
    metrics: Sequence[str | NamedMetric],
    threads: int | None = None,
    hashes: bool = False,
    ending: Ending | None = None,
) -> BatchResult:
    """Drive a batch in which *.control_period may vary as well.

    Results keep the order of the runs.
    """
    if PERIOD not in vary:
        return batch(
            configurations,
            duration,
            vary,
            metrics=metrics,
            threads=threads,
            hashes=hashes,
            ending=ending,
        )
    periods = vary[PERIOD]
    found: dict[str, np.ndarray] = {}
    failed: dict[int, str] = {}
    signal_hashes, ends = [""] * len(periods) if hashes else [], np.full(len(periods), np.nan)
    # All runs of one batch share their instants, so each period is a batch of its own.
    for period in dict.fromkeys(periods):
        runs = [run for run, each in enumerate(periods) if each == period]
        columns = {
            name: [column[run] for run in runs] for name, column in vary.items() if name != PERIOD
        }
        changed = {role: each.changed({_PERIOD: period}) for role, each in configurations.items()}
        of = batch(
            changed,
            duration,
            columns,
            metrics=metrics,
            threads=threads,
            hashes=hashes,
            ending=ending,
        )
        ends[runs] = of.ends
        for name, values in of.metrics.items():
            # Back to the places that the runs had in the caller's order.
            found.setdefault(name, np.full(len(periods), np.nan))[runs] = values
        failed |= {runs[number]: text for number, text in of.failed.items()}
        # Not strict: there are none if they are not asked for.
        for run, each in zip(runs, of.hashes, strict=False):
            signal_hashes[run] = each
    return BatchResult(found, {}, np.array([]), failed, ends, signal_hashes)
