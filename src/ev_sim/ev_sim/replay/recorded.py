"""The recorded signals of a run, to be replayed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.topics import TOPICS, Topic
from ev_msgs_py.refusal import ParameterError
from ev_sim.recording.recording import Recording
from ev_sim.scenarios.parameter_file import ParameterFile


@dataclass(frozen=True)
class Recorded:
    """The signals of a run at its instants, from time zero; a message that is missing holds the one before.

    `period` in nanoseconds. By topic, `came` (n,) says at which instants a message was there; `arrivals` (n,) when it
    was recorded [ns], -1 if it was not; it is empty of a run in lockstep, whose bag knows stamps alone. `parameters`
    is what the nodes of `namespace` were told, if that is known. `notes`: what has been left out.
    """

    source: Path
    namespace: str
    period: int
    recording: Recording
    came: Mapping[Topic, np.ndarray]
    arrivals: Mapping[Topic, np.ndarray] = field(default_factory=dict)
    parameters: ParameterFile | None = None
    notes: tuple[str, ...] = ()

    @property
    def topics(self) -> tuple[Topic, ...]:
        """Those that were recorded, in the order of the topic table."""
        return tuple(self.came)

    def has(self, signal: type) -> bool:
        """Whether a signal was recorded."""
        return TOPICS[signal] in self.came

    @property
    def duration(self) -> float:
        """Time of the last instant [s]."""
        return stamps.to_seconds((len(self.recording.time) - 1) * self.period)


def refuse_short(source: Path, instants: int) -> None:
    """ParameterError unless there are two instants at least: without a step nothing is answered."""
    if instants < 2:
        raise ParameterError(f"{source} holds {instants} whole instants of a run, allowed are two or more")
