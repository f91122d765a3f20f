"""The watcher of a run in processes: it follows simulated time, notices processes that end, and names silent nodes.

How it works: each node reports on its line to the runner (`node_reports`) how far it is and for
whom it waits. A node that waits names others, so the one at the end of that chain, which reports
nothing, is the one that does not answer. A chain that comes back ends with the node whose messages
do not arrive: it waits for answers to them. In lockstep all wait for the master, and it waits for
one of them. Real time that has begun waits for no node, and the recorder is asked.
"""

from __future__ import annotations

import math
import time
from collections.abc import Collection, Sequence
from pathlib import Path

from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.roles import MASTER, RECORDER
from ev_stack.recording.outcome import RunFailed
from ev_stack.running.node_process import NodeProcess
from ev_stack.running.node_reports import NodeReports
from ev_stack.scenarios.records import Run

_RECENT = 0.6  # s for nodes to report, every 0.2 s, for whom they wait
_TO_COME_UP = 10.0  # s that nodes may take to start
# s for the first step of our own nodes: one that was edited compiles its plant on a busy machine
_TO_BEGIN = 300.0
_PATIENCE = 2.0  # s for a last report to arrive
# s more for a recorder behind a plant in real time that has reported its end
_TO_CATCH_UP = 20.0


def silent_node(reports: NodeReports, present: Collection[str], realtime: bool) -> list[str]:
    """The nodes that wait for each other; the last one does not answer."""
    if MASTER not in present:
        return [RECORDER]
    # Real time that has begun: the master waits for no node.
    follows_the_clock = realtime and not reports.waits_for(MASTER, _RECENT)
    chain = [RECORDER if follows_the_clock else MASTER]
    while True:
        waited_for = reports.waits_for(chain[-1], _RECENT) or ()
        candidates = [each for each in waited_for if each in present]
        # The end of the chain, or a circle.
        if not candidates or candidates[0] in chain:
            return chain
        chain.append(candidates[0])


def is_stopped(pid: int) -> bool:
    """Return whether a process stands still by SIGSTOP or the like."""
    try:
        content = (Path("/proc") / str(pid) / "stat").read_text()
        # The state stands behind the name in parentheses, which may hold blanks and parentheses
        # itself.
        return content.rpartition(")")[2].split()[0] in "Tt"
    except (OSError, IndexError):
        return False


class RunWatcher:
    """Watches the processes of a run until plant and recorder have ended.

    `look` and `notice_ends` are to be called often. It is `patient` with nodes of others, which may
    load for long, or stand at a breakpoint.
    """

    def __init__(
        self, run: Run, nodes: Sequence[NodeProcess], reports: NodeReports, patient: bool = False
    ) -> None:
        now = time.monotonic()
        self._nodes = nodes
        self._reports = reports
        self._realtime = run.realtime
        # The last instant of the run [s].
        self.last = stamps.to_seconds(stamps.from_seconds(run.duration) // run.period * run.period)
        answer_timeout = run.configurations[MASTER].extra.answer_timeout
        self._standstill = max(answer_timeout - 0.2, _RECENT)  # a report may be 0.2 s old
        self._present = {node.name: node.process.pid for node in nodes}
        self._begins_by = math.inf if patient else now + _TO_BEGIN
        self._time = reports.time
        self._moved_at = now  # wall time at which simulated time was seen to move, or to rest
        self._is_named = False
        self._looked_at = now
        # Wall times of the last look at a car at rest in time, and of the first one at its end.
        self._began_at: float | None = None
        self._arrived_at: float | None = None
        # wall time up to which the recorder may report that it has all
        self._recorder_by = math.inf

    @property
    def is_over(self) -> bool:
        """True if plant and recorder have ended."""
        return not {MASTER, RECORDER} & self._present.keys()

    @property
    def wall_time(self) -> float:
        """Seconds from the first step to the last instant."""
        if self._began_at is None or self._arrived_at is None:
            return 0.0
        return self._arrived_at - self._began_at

    def look(self) -> list[str]:
        """Follow simulated time, and return lines for the user.

        Raises RunFailed if no step will be taken.
        """
        now = time.monotonic()
        self._reports.look()
        self._follow_time(now)
        self._looked_at = now
        if now > self._begins_by:
            raise RunFailed(
                f"no step was taken within {_TO_BEGIN:g} s: the nodes do not find or answer each"
                " other"
            )
        return [*self._reports.new_words(), *self._name_silent_node(now)]

    def notice_ends(self) -> None:
        """Note nodes that have ended in order.

        Raises RunFailed if in another way, or before the run has.
        """
        now = time.monotonic()
        for node in self._nodes:
            if node.process.poll() is not None:
                self._notice_end(node, now)
        if self.is_over and self._arrived_at is None:
            self._arrived_at = now

    def _follow_time(self, now: float) -> None:
        reports = self._reports
        # A step may take seconds at a slow pace: the master waits for nothing but its time then.
        waits_for_its_time = reports.waits_for(MASTER, _RECENT) == []
        has_moved = reports.time != self._time
        if has_moved or reports.rests or waits_for_its_time:
            self._moved_at = now
            self._is_named = False
        if has_moved:
            self._time = reports.time
            self._recorder_by = math.inf  # it still has to keep what the plant sent before its end
        if reports.time > 0 or reports.rests:
            self._begins_by = math.inf
        # The look before: then the first step had not been taken yet.
        if self._began_at is None and reports.time > 0:
            self._began_at = self._looked_at
        if self._arrived_at is None and reports.time >= self.last:
            self._arrived_at = now

    def _name_silent_node(self, now: float) -> list[str]:
        """A line on the node that does not answer, once for each time that the run stands still."""
        stands_for = now - self._moved_at
        if self._is_named or stands_for <= self._standstill:
            return []
        at = f"at {self._time:g} s of simulated time"
        # Before all else: a node that was stopped by a signal makes all others wait.
        stopped = [name for name, pid in self._present.items() if is_stopped(pid)]
        if stopped:
            self._is_named = True
            return [f"stopped by a signal: {', '.join(stopped)}, {at}"]
        # Nodes load for seconds before the first step.
        if self._time == 0.0 and stands_for < _TO_COME_UP:
            return []
        self._is_named = True
        chain = silent_node(self._reports, self._present, self._realtime)
        reasons: dict[str, None] = {}
        for node in chain:
            reasons |= dict.fromkeys(self._reports.why_it_waits(node))
        line = f"node {chain[-1]} does not answer, {at}"
        return [f"{line}: {'; '.join(reasons)}" if reasons else line]

    def _notice_end(self, node: NodeProcess, now: float) -> None:
        code = node.process.returncode
        at = f"at {self._time:g} s of simulated time"
        # Only plant and recorder end by themselves; any other node that ends is missing.
        if code != 0 or node.name not in (MASTER, RECORDER):
            raise RunFailed(f"{node.failure()}, {at}")
        self._present.pop(node.name, None)
        # From the first time that the end was noticed on: this is called again and again.
        self._recorder_by = min(self._recorder_by, now + _PATIENCE)
        has_timing = bool(self._reports.timing)  # the plant in real time has reported its end
        given_up = self._recorder_by + (_TO_CATCH_UP if has_timing else 0.0)
        if self._time < self.last and now > given_up:
            is_slow = node.name == MASTER and has_timing
            what = f"node {RECORDER} lacks what was sent last" if is_slow else node.failure()
            raise RunFailed(f"{what}, {at}")
