"""Metrics of whole runs of a batch; the channels of a run are kept until it is measured."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ev_core.lockstep.configuration import Configuration
from ev_msgs_py.contract.topics import TOPICS
from ev_stack.batches.observer import Observation
from ev_stack.measures.named import DrivenRun, NamedMetric, driven_run, refuse_unmeasurable
from ev_stack.measures.own_metrics import named_metrics
from ev_stack.recording.offline import OF_THE_CAR, written_topics
from ev_stack.recording.recording import Recording, signal_hash


@dataclass(frozen=True)
class Ending:
    """Early end of runs: at the first multiple of `every` [s] at which `is_over` returns True.

    It is asked with the run so far, and with the sample up to which it was asked before.
    """

    is_over: Callable[[DrivenRun, int], bool]
    every: float = 1.0


class WholeRun:
    """Memory for channels of a run, and for those of the car in front of the sensors of roles."""

    def __init__(
        self, channels: Sequence[str], of_roles: Mapping[str, Sequence[str]], times: np.ndarray
    ) -> None:
        # As an observation of one run, with every period and without reductions.
        self.shown = Observation(channels, 1, (), 1, len(times))
        self._of_roles, self._times = of_roles, times
        self._true: list[Observation] = []

    def truth_of(self, role: str) -> Observation | None:
        """Keeper of the true motion of a role with sensors or faults.

        None if it has none that counts.
        """
        if role not in self._of_roles:
            return None
        self._true.append(Observation(self._of_roles[role], 1, (), 1, len(self._times)))
        return self._true[-1]

    def recorded(self, instants: int) -> tuple[Recording, Recording]:
        """Signals up to an instant as shown, and the true motion, driven again."""
        times = self._times[:instants]
        shown = Recording(times, _only_run(self.shown, instants))
        true = {
            name: values
            for each in self._true
            for name, values in _only_run(each, instants).items()
        }
        # True numbers take the place of what the sensors have shown.
        return shown, Recording(times, {**shown.channels, **true}, shown) if true else shown


def _only_run(observation: Observation, instants: int) -> dict[str, np.ndarray]:
    return {name: values[0, :instants] for name, values in observation.signals().items()}


class WholeRuns:
    """Metrics of each run once it is driven.

    `values` have one number for each run, (runs,), by name, in the units `units`.

    NaN stands where there is none. `ends` are when the runs ended [s], (runs,), and `hashes` those
    of the published signals if they are asked for, NaN and empty for a run that has not ended.
    ParameterError for texts that name or declare no metric, and for a metric of channels that the
    graph does not have.
    """

    def __init__(
        self,
        texts: Sequence[str | NamedMetric],
        configurations: Mapping[str, Configuration],
        runs: int,
        times: np.ndarray,
        hashed: bool = False,
    ) -> None:
        self._metrics, self._times = named_metrics(texts), times
        refuse_unmeasurable(self._metrics.values(), configurations)
        self._channels = [
            name for topic in written_topics(configurations) for name in topic.channels
        ]
        # As `true_motion`, which takes a run of a single instant as it is.
        self._of_roles = {
            role: [
                name
                for signal in configurations[role].method.writes
                for name in TOPICS[signal].channels
            ]
            for role in OF_THE_CAR
            if role in configurations and len(times) > 1
        }
        self.units = {name: each.unit for name, each in self._metrics.items()}
        self.values = {name: np.full(runs, np.nan) for name in self._metrics}
        self.hashes = [""] * runs if hashed else []
        self.ends = np.full(runs, np.nan)

    def whole_run(self) -> WholeRun:
        """The memory for a run."""
        return WholeRun(self._channels, self._of_roles, self._times)

    def take(
        self, run: int, whole: WholeRun, instants: int, configurations: Mapping[str, Configuration]
    ) -> None:
        """Measure a run that has ended after some instants, of these configurations."""
        shown, motion = whole.recorded(instants)
        self.ends[run] = shown.time[-1]
        if self.hashes:
            self.hashes[run] = signal_hash(shown)
        driven = driven_run(motion, configurations)
        for name, metric in self._metrics.items():
            # Without a value the NaN from the start stays.
            value = metric.measured(driven).value
            if value is not None:
                self.values[name][run] = value
