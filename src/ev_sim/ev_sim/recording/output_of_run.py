"""Where a recorded run goes: its folder, its recorder, and the files at its end."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ev_core.nodes.master.real_time import LONGEST
from ev_core.parameters.declaration import setting
from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.roles import RECORDED
from ev_msgs_py.contract.topics import TOPICS, Topic
from ev_msgs_py.refusal import ParameterError, quoted
from ev_sim.recording.files_of_run import BAG, SIGNALS
from ev_sim.recording.run_recorder import RunRecorder

_ALL_TOPICS = tuple(TOPICS[signal].name for signal in RECORDED)


@dataclass(frozen=True, slots=True)
class RecorderParameters:
    """What is recorded and where it goes."""

    directory: str = setting("recording", about="folder for bag/ and signals.npz, made if need be", read_only=True)
    topics: tuple[str, ...] = setting(
        _ALL_TOPICS, choices=_ALL_TOPICS, about="topics that belong to every step of this run", read_only=True
    )
    bag: bool = setting(True, about="write a bag besides signals.npz", read_only=True)
    control_period: float = setting(
        0.01, unit="s", low=1e-4, high=1.0, about="step of the graph, the same for all nodes", read_only=True
    )
    mode: str = setting(
        "lockstep",
        choices=("lockstep", "realtime"),
        about="lockstep: every topic has every step; realtime: a step that is missing holds the one before",
        read_only=True,
    )
    duration: float = setting(
        0.0, unit="s", low=0.0, high=LONGEST, about="the node ends when it holds this time; 0: never", read_only=True
    )


class OutputOfRun:
    """Makes the folder; ParameterError if it has a recording already. `names` are the full names of the topics."""

    def __init__(self, p: RecorderParameters, topics: Sequence[Topic], names: Sequence[str]) -> None:
        self._directory = Path(p.directory)
        if any(os.path.lexists(self._directory / name) for name in ((BAG, SIGNALS) if p.bag else (SIGNALS,))):
            raise ParameterError(
                f"parameter directory: {quoted(p.directory)} is refused, allowed is one without a recording"
            )
        self._directory.mkdir(parents=True, exist_ok=True)
        period = stamps.from_seconds(p.control_period)
        self._last = stamps.from_seconds(p.duration) // period * period
        self.recorder = RunRecorder(
            topics, names, period, self._directory, p.bag, p.mode == "realtime", self._last or None
        )
        self._wrote = False

    @property
    def is_complete(self) -> bool:
        """Whether everything up to the end of the run is held."""
        return 0 < self._last <= self.recorder.held

    def write(self) -> None:
        """Write signals.npz with all complete steps and close the bag, once."""
        if not self._wrote:
            self._wrote = True
            self.recorder.close(self._directory / SIGNALS)
