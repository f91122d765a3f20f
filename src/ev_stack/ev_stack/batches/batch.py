"""Many runs of one graph in one call, on all cores, each with the bits that it has alone.

How it works: each run is a row of addresses of compiled parts (`placed`), as in a single run. A
call of compiled code lets go of Python's lock, so that plain threads drive runs side by side. They
take portions of runs from one queue. Behind the parts that answer stands an observer (`observer`),
which keeps what is asked for while the loop runs; metrics of whole runs need all channels, which
`whole_runs` keeps until the run is measured. With an `Ending` the loop is left from time to time to
look.
"""

from __future__ import annotations

import math
import os
from collections import deque
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import pairwise
from queue import SimpleQueue
from threading import Thread
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np

from ev_core.compiled.loop import FINISHED, Parts, run_through
from ev_core.lockstep.configuration import Configuration
from ev_core.lockstep.graph import check_graph
from ev_msgs_py.arguments import checked
from ev_msgs_py.contract import frame, stamps
from ev_msgs_py.contract.fields import SignalError
from ev_msgs_py.refusal import ParameterError, quoted, unknown_name
from ev_stack.batches import observer
from ev_stack.batches.observer import Observation, Reduction, result
from ev_stack.batches.placed import NOTHING, Placed, Placing
from ev_stack.batches.variation import Variation
from ev_stack.batches.whole_runs import Ending, WholeRuns
from ev_stack.measures.named import NamedMetric, driven_run
from ev_stack.recording.data_frame import data_frame
from ev_stack.recording.offline import written_topics

if TYPE_CHECKING:
    from pandas import DataFrame

Threads = Annotated[int | None, "a whole number, at least 1"]

_PORTIONS = 16  # for each thread


class Runs:
    """Driver of single runs of a batch, on any thread, with the parts that `Placing` gives each."""

    def __init__(
        self,
        configurations: Mapping[str, Configuration],
        variation: Variation,
        initial_states: Mapping[str, np.ndarray],
        observation: observer.Observation,
        times: np.ndarray,
        measures: WholeRuns | None = None,
        ending: Ending | None = None,
    ) -> None:
        # The observer is compiled here, and not by several threads at once.
        observer.function()
        self._placing = Placing(configurations, variation, initial_states)
        self._roles, self._observation, self._times = tuple(configurations), observation, times
        self._measures, self._ending = measures, ending
        last = len(times) - 1
        # In periods; times[1] is one, and a run of a single instant has none.
        look = max(round(ending.every / times[1]) if ending and last else last, 1)
        # Stretches of instants between two looks at the ending; one leg without an ending.
        self._legs = list(pairwise([0, *range(look, last, look), last]))

    def drive_some(self, runs: Iterable[int]) -> dict[int, str]:
        """Drive some of the runs; return time and name of each number that was not finite."""
        return {run: text for run in runs if (text := self._drive(run))}

    def _drive(self, run: int) -> str:
        """Drive one run; where a number is not finite it stops, and the answer is not empty."""
        whole = self._measures.whole_run() if self._measures else None
        before: list[Placed] = []
        for role in self._placing.answering:
            before += self._placing.placed(role, run)
        # Behind all that answer the frame of the instant is complete.
        before.append(Placed("", NOTHING, self._observation, self._observation.state(run)))
        before += [Placed("", NOTHING, whole.shown, whole.shown.state())] if whole else []
        behind: list[Placed] = []
        for role in self._placing.integrating:
            behind += self._placing.placed(role, run, whole)
        # Addresses only: `before` and `behind` keep alive what they point to.
        rows = np.array([placed.row for placed in (*before, *behind)], np.int64)
        parts = Parts(rows, len(before))
        frames, stopped = np.zeros((2, frame.SIZE)), np.zeros(3, np.int64)
        of = {role: self._placing.configuration(role, run) for role in self._roles}
        for first, last in self._legs:
            status = run_through(frames, self._times, first, last, parts, stopped)
            if status != FINISHED:
                return self._why(status, frames, stopped, (*before, *behind))
            if (
                self._ending
                and whole
                and self._ending.is_over(driven_run(whole.recorded(last + 1)[1], of), first)
            ):
                break
        if self._measures and whole:
            self._measures.take(run, whole, last + 1, of)
        return ""

    def _why(
        self, status: int, frames: np.ndarray, stopped: np.ndarray, placed: Sequence[Placed]
    ) -> str:
        """The line on what was not finite, or what a law raised."""
        instant, place, which = stopped.tolist()
        stopped_at = placed[place]
        is_answer = stopped_at.role in self._placing.answering
        # Answers go into the frame that was read, integration into the other.
        here = frames[which if is_answer else 1 - which]
        # For its initial outputs a part that integrates gets no frame.
        is_start = instant == 0 and not is_answer
        method = self._placing.configuration(stopped_at.role, 0).method
        error = stopped_at.error(status, None if is_start else here, frames[which], method)
        if isinstance(error, SignalError):
            return f"at {self._times[instant]:g} s {error}"
        return str(error)  # it names the time itself


@dataclass(frozen=True, repr=False)
class BatchResult:
    """Kept numbers of the runs of a batch.

    `metrics`: by name one number for each run, (runs,), NaN where it cannot be measured. `signals`:
    by channel the samples of each run at the instants `time` [s], (runs, samples). `failed`: by
    number of the run what was not finite and when; such a run has stopped there, its metrics and
    what would have come later are NaN. `hashes`: the signal hash of each run if asked for, empty
    where it has failed. `ends`: when each run ended [s], (runs,), NaN where it has failed.
    `varied`: by name the value of each run. `units`: of what varied and of the metrics, by name.
    """

    metrics: Mapping[str, np.ndarray]
    signals: Mapping[str, np.ndarray]
    time: np.ndarray
    failed: Mapping[int, str]
    ends: np.ndarray
    hashes: Sequence[str] = ()
    varied: Mapping[str, Sequence[Any]] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)

    def data_frame(self) -> DataFrame:
        """A row for each run as a table of pandas: what varied, the metrics, and when it ended.

        `attrs["units"]` has the unit of each column by name.
        """
        columns = {**self.varied, **self.metrics, "end": self.ends}
        return data_frame(columns, {**self.units, "end": "s"})

    def __repr__(self) -> str:
        kept = ", ".join(
            f"{name} {np.shape(values)}"
            for name, values in {**self.metrics, **self.signals}.items()
        )
        return (
            f"BatchResult of {kept or 'nothing, as neither metrics nor signals were named'};"
            f" {len(self.failed)} failed"
        )


@checked
def batch(
    configurations: Mapping[str, Configuration],
    duration: Annotated[float, "0 s or more"],
    vary: Mapping[str, Iterable[Any]] | None = None,
    initial_states: Mapping[str, Any] | None = None,
    signals: Sequence[str] = (),
    every: Annotated[int, "a whole number of periods, at least 1"] = 1,
    metrics: Mapping[str, Reduction] | Sequence[str | NamedMetric] | None = None,
    threads: Threads = None,
    hashes: bool = False,
    ending: Ending | None = None,
) -> BatchResult:
    """Drive runs of a graph from rest to `duration` [s], as `run_offline` does each of them.

    `vary` has by ROLE.PARAMETER, or *.PARAMETER for all roles, one value for each run;
    `initial_states` by role one row of the method's state for each run, (runs, size). Each run
    keeps the channels in `signals` at every `every`-th period, and `metrics`: reductions of
    channels over all periods by name, gathered in the compiled loop (`observer`), or texts as in
    the file of a scenario, computed from the true motion (`measures.expression`), and its signal
    hash if asked to. Runs that an `ending` ends before have the bits of a run of that duration, and
    reductions are refused with it. Without `threads` there are as many as cores. ParameterError if
    a name or value is refused, if roles do not fit together, if a method is plain Python, all
    before anything runs, or if a run's values make no method.
    """
    check_graph(configurations)
    reductions, texts = (metrics, ()) if isinstance(metrics, Mapping) else ({}, metrics or ())
    # A single row is that of one run.
    states = {}
    for role, rows in (initial_states or {}).items():
        if role not in configurations:
            raise unknown_name("role", role, configurations)
        try:
            states[role] = np.atleast_2d(np.asarray(rows, float))
        except (TypeError, ValueError):
            raise ParameterError(
                f"initial_states of {role}: {quoted(rows)} is refused, expected rows of numbers,"
                " all of one length"
            ) from None
    variation = Variation(
        configurations, vary or {}, {role: len(rows) for role, rows in states.items()}
    )
    _refuse_channels(
        configurations, [*signals, *(reduction.channel for reduction in reductions.values())]
    )
    if every < 1:
        raise ParameterError(
            f"every: {every!r} is refused, expected a whole number of periods, at least 1"
        )
    workers = number_of_threads(threads)
    if ending and reductions:
        raise ParameterError(
            "reductions are refused for runs that may end before, expected metrics of whole runs"
        )
    if not 0.0 <= duration < math.inf:
        raise ParameterError(f"duration: {duration!r} is refused, expected 0 s or more")
    period = next(iter(configurations.values())).period
    instants = stamps.from_seconds(duration) // period + 1
    times = np.array([stamps.to_seconds(n * period) for n in range(instants)])
    observation = Observation(
        signals, every, tuple(reductions.values()), variation.runs, len(times)
    )
    measures = (
        WholeRuns(texts, configurations, variation.runs, times, hashes)
        if texts or hashes or ending
        else None
    )
    runs = Runs(configurations, variation, states, observation, times, measures, ending)
    # In portions: handing over each run alone costs a tenth of making it; the last ones shall be
    # short.
    size = max(variation.runs // (_PORTIONS * workers), 1)
    portions = [
        range(each, min(each + size, variation.runs)) for each in range(0, variation.runs, size)
    ]
    failed = _driven(runs, portions, workers)
    known = frame.units()
    units = {name: known[reduction.channel] for name, reduction in reductions.items()}
    reduced, ends = (
        observation.reduced(),
        measures.ends if measures else np.full(variation.runs, times[-1]),
    )
    # What was gathered up to a failure is no reduction of a whole run.
    reduced[list(failed)] = ends[list(failed)] = np.nan
    return BatchResult(
        {
            **{
                name: result(m.kind, reduced[:, i], len(times))
                for i, (name, m) in enumerate(reductions.items())
            },
            **(measures.values if measures else {}),
        },
        observation.signals(),
        times[::every],
        failed,
        ends,
        measures.hashes if measures else (),
        variation.columns,
        {**variation.units(), **units, **(measures.units if measures else {})},
    )


def number_of_threads(threads: int | None) -> int:
    """Number of threads that is meant, as many as cores without one; ParameterError if refused."""
    if threads is None:
        return len(os.sched_getaffinity(0))
    if threads < 1:
        raise ParameterError(
            f"threads: {threads!r} is refused, expected a whole number, at least 1"
        )
    return threads


def _driven(runs: Runs, portions: Sequence[range], threads: int) -> dict[int, str]:
    """Drive the runs on threads; the answer has those that have stopped, and why.

    Ctrl-C ends the wait at once: threads that stand in a law without an end go with the process.
    """
    waiting, done = deque(enumerate(portions)), SimpleQueue[tuple[int, Any]]()

    def drive() -> None:
        while waiting:
            with suppress(IndexError):  # another thread has taken the last one
                number, portion = waiting.popleft()
                try:
                    done.put((number, runs.drive_some(portion)))
                except BaseException as error:  # for the waiting thread
                    done.put((number, error))

    for _ in range(min(threads, len(portions))):
        Thread(target=drive, daemon=True).start()
    try:
        # Every portion answers once, with a result or an error, so this ends.
        found = dict(done.get() for _ in portions)
    finally:
        # The other threads end with the portion that they have.
        waiting.clear()
    failed: dict[int, str] = {}
    for number in range(len(portions)):
        # In the order of the runs: which error is raised must not depend on the threads.
        if isinstance(found[number], BaseException):
            raise found[number]
        failed |= found[number]
    return failed


def _refuse_channels(configurations: Mapping[str, Configuration], channels: Iterable[str]) -> None:
    """A channel that no method writes would be zero for ever."""
    known = [name for topic in written_topics(configurations) for name in topic.channels]
    for name in channels:
        if name not in known:
            raise unknown_name("channel", name, known)
