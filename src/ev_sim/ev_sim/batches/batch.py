"""Many runs of one graph in one call, on all cores, each with the bits that it has alone."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np

from ev_core.lockstep.configuration import Configuration
from ev_core.lockstep.graph import check_graph
from ev_msgs_py.contract import frame, stamps
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.refusal import ParameterError, unknown_name
from ev_sim.batches.observer import Observation, Reduction, result
from ev_sim.batches.runs import Runs, Variation

_PORTIONS = 16  # for each thread


@dataclass(frozen=True)
class BatchResult:
    """What is kept of the runs of a batch.

    `metrics`: by name one number for each run, (runs,). `signals`: by channel the samples of each run at the instants
    `time` [s], (runs, samples). `failed`: by number of the run what was not finite and when; such a run has stopped
    there, its metrics and what would have come later are NaN.
    """

    metrics: Mapping[str, np.ndarray]
    signals: Mapping[str, np.ndarray]
    time: np.ndarray
    failed: Mapping[int, str]


def batch(
    configurations: Mapping[str, Configuration],
    duration: float,
    vary: Mapping[str, Iterable[Any]] | None = None,
    initial_states: Mapping[str, Any] | None = None,
    signals: Sequence[str] = (),
    every: int = 1,
    metrics: Mapping[str, Reduction] | None = None,
    threads: int | None = None,
) -> BatchResult:
    """Drive runs of a graph from rest to `duration` [s], as `run_offline` does each of them.

    `vary` has by ROLE.PARAMETER, or *.PARAMETER for all roles, one value for each run; `initial_states` by role one row
    of the method's state for each run, (runs, size). Of each run are kept: of the channels in `signals` the sample of
    every `every`-th period, and `metrics`, reductions of channels over all periods (`observer`). Without `threads`
    there are as many as cores. ParameterError if a name or value is refused, if the roles do not fit together, if a
    method runs in plain Python only, all before anything runs, or if a method cannot be made with the values of a run.
    """
    check_graph(configurations)
    metrics = metrics or {}
    states = {role: np.atleast_2d(np.asarray(rows, float)) for role, rows in (initial_states or {}).items()}
    for role in states:
        if role not in configurations:
            raise unknown_name("role", role, configurations)
    variation = Variation(configurations, vary or {}, {role: len(rows) for role, rows in states.items()})
    _refuse_channels(configurations, [*signals, *(reduction.channel for reduction in metrics.values())])
    if isinstance(every, bool) or not isinstance(every, int) or every < 1:
        raise ParameterError(f"every: {every!r} is refused, allowed is a whole number of periods, at least 1")
    period = next(iter(configurations.values())).period
    times = np.array([stamps.to_seconds(n * period) for n in range(stamps.from_seconds(duration) // period + 1)])
    if not len(times):
        raise ParameterError(f"duration: {duration!r} is refused, allowed is 0 s or more")
    observation = Observation(signals, every, tuple(metrics.values()), variation.runs, len(times))
    runs = Runs(configurations, variation, states, observation, times)
    workers = threads or len(os.sched_getaffinity(0))
    with ThreadPoolExecutor(workers) as pool:
        portions = pool.map(runs.drive_some, _shared_out(variation.runs, workers))
        failed = {run: text for portion in portions for run, text in portion.items()}
    reduced = observation.reduced()
    reduced[list(failed)] = np.nan
    return BatchResult(
        {name: result(m.kind, reduced[:, i], len(times)) for i, (name, m) in enumerate(metrics.items())},
        observation.signals(),
        times[::every],
        failed,
    )


def _shared_out(runs: int, workers: int) -> list[range]:
    """The runs in portions: handing over each alone costs a tenth of making it; the last ones shall be short."""
    size = max(runs // (_PORTIONS * workers), 1)
    return [range(begin, min(begin + size, runs)) for begin in range(0, runs, size)]


def _refuse_channels(configurations: Mapping[str, Configuration], channels: Iterable[str]) -> None:
    """A channel that no method writes would be zero for ever."""
    written = {signal for configuration in configurations.values() for signal in configuration.method.writes}
    known = [name for signal in frame.PLACES if signal in written for name in TOPICS[signal].channels]
    for name in channels:
        if name not in known:
            raise unknown_name("channel", name, known)
