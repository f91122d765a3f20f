"""A run whose nodes are processes of their own, watched until plant and recorder have come to their end."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from pathlib import Path

from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.roles import MASTER, RECORDER
from ev_msgs_py.nodes.stop_request import StopRequest
from ev_sim.running.beginning import Beginning
from ev_sim.running.files_of_run import SIGNALS
from ev_sim.running.hanging import Hanging
from ev_sim.running.node_process import NodeProcess
from ev_sim.running.outcome import Outcome, Progress, RunFailed, not_reproducible
from ev_sim.running.progress_bar import announce
from ev_sim.running.recording.recording import load
from ev_sim.running.scenarios.scenario import Run
from ev_sim.running.told import Told

_LOOK_PERIOD = 0.05  # s of wall time between looks at the processes
_PATIENCE = 2.0  # s for a last word to arrive
_TO_CATCH_UP = 20.0  # s more for a recorder behind a plant in real time that said that it has come to its end


class WatchedRun:
    """Follows simulated time and the processes of a run, and says which node does not answer."""

    def __init__(self, run: Run, nodes: Sequence[NodeProcess], told: Told) -> None:
        self._run, self._nodes, self._told = run, nodes, told
        self._last = stamps.to_seconds(stamps.from_seconds(run.duration) // run.period * run.period)
        answer_timeout = run.configurations[MASTER].extra.answer_timeout
        pids = {node.name: node.process.pid for node in nodes}
        self._hanging = Hanging(told, pids, answer_timeout, run.realtime)
        self._patience = math.inf  # wall time up to which the recorder may tell that it has everything
        self._began: float | None = None  # wall time of the last look at a car at rest in time
        self._arrived: float | None = None  # wall time of the first look at a car at its last instant

    def drive(self, beginning: Beginning, progress: Progress, stop: StopRequest) -> bool:
        """Watch the run up to its end; False where it has not begun and never will, which is said.

        RunFailed if a node ends before the run does, KeyboardInterrupt if a stop is asked for.
        """
        ending = {MASTER, RECORDER}
        while ending:
            if stop.received:
                raise KeyboardInterrupt
            looked = time.monotonic()
            time.sleep(_LOOK_PERIOD)
            self._follow_time(looked)
            progress(self._told.time)
            if beginning.is_missed(self._told):
                announce("the time of day was set back, and the run has not begun since: its nodes are started anew")
                return False
            for word in (*self._told.new_words(), self._hanging.look()):
                if word is not None:
                    announce(word)
            ending -= {node.name for node in self._nodes if self._has_ended(node)}
        self._arrived = self._arrived or time.monotonic()
        progress(self._run.duration)
        return True

    def outcome(self, directory: Path) -> Outcome:
        """What a run gave that has come to its end, and its nodes as well; RunFailed if its recorder was stopped."""
        self._told.look()
        recording = load(directory / SIGNALS)
        if recording.time[-1] < self._last - 0.5 * stamps.to_seconds(self._run.period):  # real time does not wait
            raise RunFailed(f"node {RECORDER} was stopped, at {recording.time[-1]:g} s of simulated time")
        wall_time = self._arrived - self._began if self._arrived and self._began else 0.0
        warnings = not_reproducible(self._run, self._told, recording)
        return Outcome(recording, wall_time, warnings, self._told.notes, self._told.timing)

    def _follow_time(self, looked: float) -> None:
        before = self._told.time
        self._told.look()
        if self._told.time != before:
            self._patience = math.inf  # the recorder still has to keep what the plant said before its end
        if self._began is None and self._told.time > 0:
            self._began = looked
        if self._arrived is None and self._told.time >= self._last:
            self._arrived = time.monotonic()

    def _has_ended(self, node: NodeProcess) -> bool:
        """Whether a node has come to its end in order; RunFailed if in another way, or before the run has."""
        code = node.process.poll()
        if code is None:
            return False
        if code != 0 or node.name not in (MASTER, RECORDER):
            raise RunFailed(f"{node.failure()}, at {self._told.time:g} s of simulated time")
        self._hanging.has_ended(node.name)
        now, real_time = time.monotonic(), bool(self._told.timing)
        self._patience = min(self._patience, now + _PATIENCE)
        if self._told.time < self._last and now > self._patience + (_TO_CATCH_UP if real_time else 0.0):
            slow = node.name == MASTER and real_time  # the plant has told that it came to its end
            who = f"node {RECORDER} lacks what was said last," if slow else node.failure()
            raise RunFailed(f"{who} at {self._told.time:g} s of simulated time")
        return True
