"""Where a recorded run goes: its folder, its recorder, and the files at its end."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.topics import Topic
from ev_msgs_py.parameters.declaration import ParameterError
from ev_msgs_py.parameters.shown import quoted
from ev_sim.running.files_of_run import BAG, SIGNALS
from ev_sim.running.recording.recorder_parameters import RecorderParameters
from ev_sim.running.recording.run_recorder import RunRecorder


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
