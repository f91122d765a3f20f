"""Metrics of the whole runs of a batch: all channels of a run are kept until it is measured, and no longer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ev_core.lockstep.configuration import Configuration
from ev_sim.batches.observer import Observation
from ev_sim.measures.own_metrics import named_metrics
from ev_sim.measures.registry import NamedMetric, driven_run, refuse_unmeasurable
from ev_sim.recording.offline import true_motion, written_topics
from ev_sim.recording.recording import Recording, signal_hash


class WholeRuns:
    """What is measured of each run once it is driven; `values` have by name one number for each run, (runs,).

    NaN stands where there is none. `hashes` are those of the published signals if they are asked for, empty for a run
    that has not ended. ParameterError for texts that name or declare no metric, and for a metric of
    channels that the graph does not have.
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
        self._channels = [name for topic in written_topics(configurations) for name in topic.channels]
        self.values = {name: np.full(runs, np.nan) for name in self._metrics}
        self.hashes = [""] * runs if hashed else []

    def observation(self) -> Observation:
        """The memory for all channels of a run."""
        return Observation(self._channels, 1, (), 1, len(self._times))

    def take(self, run: int, whole: Observation, configurations: Mapping[str, Configuration]) -> None:
        """Measure a run that has ended, of these configurations."""
        recorded = Recording(self._times, {name: values[0] for name, values in whole.signals().items()})
        if self.hashes:
            self.hashes[run] = signal_hash(recorded)
        driven = driven_run(true_motion(recorded, configurations), configurations)
        for name, metric in self._metrics.items():
            value = metric.measured(driven).value
            if value is not None:
                self.values[name][run] = value
