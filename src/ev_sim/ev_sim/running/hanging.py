"""Which node of a run that stands still does not answer: the others are heard, for they repeat what they have said."""

from __future__ import annotations

import time
from collections.abc import Mapping
from pathlib import Path

from rclpy.node import Node

from ev_msgs_py.contract.roles import MASTER, RECORDER, ROLES
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.lockstep.graph import step_order
from ev_msgs_py.lockstep.stepper import WRITERS
from ev_msgs_py.nodes.signal_io import SignalReader
from ev_msgs_py.wire.layout import MessageError
from ev_msgs_py.wire.message_format import stamp_of
from ev_sim.running.told import Told

_HEARKEN = 0.6  # s to find the writers and to hear some repetitions, which come every 0.05 s
_TO_COME_UP = 10.0  # s that nodes may take to start


class Hanging:
    """Names the node that a run waits for when nothing has gone on for some wall time; `look` is to be called often.

    The master repeats its state where no answer comes, and every node that lives answers again. So it is the master
    if nobody speaks; else the first node, in the order of a step, that says nothing, or nothing of the instant.
    """

    def __init__(self, observer: Node, told: Told, pids: Mapping[str, int], patience: float) -> None:
        self._observer, self._told, self._pids = observer, told, dict(pids)
        self._wait = max(patience - _HEARKEN - 0.2, 0.1)
        self._since = self._hearkens = time.monotonic()
        self._time = told.time
        self._ears: dict[type, SignalReader] = {}
        self._heard: dict[str, int] = {}  # newest stamp by role
        self._named = False

    def look(self) -> str | None:
        """One line on who does not answer, once for each time that the run stands still."""
        now = time.monotonic()
        if self._told.time != self._time or self._told.rests:
            self._time, self._since, self._named = self._told.time, now, False
            self._stop()
        elif self._ears:
            self._take()
            if now - self._hearkens > _HEARKEN:
                who = self._who()
                self._stop()
                self._named = True
                return f"node {who} does not answer, at {self._time:g} s of simulated time"
        elif not self._named and now - self._since > (self._wait if self._time else _TO_COME_UP):
            stopped = [name for name, pid in self._pids.items() if _is_stopped(pid)]
            if stopped:
                self._named = True
                return f"stopped by a signal: {', '.join(stopped)}, at {self._time:g} s of simulated time"
            self._hearkens = now
            self._begin()
        return None

    def has_ended(self, name: str) -> None:
        """A node has come to its end: it need not answer any more."""
        self._pids.pop(name, None)

    def _begin(self) -> None:
        for signal, topic in TOPICS.items():
            if WRITERS.get(signal) in self._pids:
                self._ears[signal] = SignalReader(self._observer, topic, lambda _: None, lambda *_: None)

    def _stop(self) -> None:
        for ear in self._ears.values():
            ear.close()
        self._ears, self._heard = {}, {}

    def _take(self) -> None:
        for signal, ear in self._ears.items():
            for message in iter(ear.take, None):
                try:
                    stamp = stamp_of(message)
                except MessageError:
                    continue
                writer = WRITERS[signal]
                self._heard[writer] = max(self._heard.get(writer, 0), stamp)

    def _who(self) -> str:
        if MASTER not in self._pids:
            return RECORDER
        order = [role for role in step_order(ROLES) if role in self._pids]
        others = [role for role in (*order, *ROLES) if role in self._pids and role != MASTER]
        if MASTER not in self._heard:
            return MASTER
        silent = [role for role in dict.fromkeys(others) if role not in self._heard]
        behind = [role for role in order if self._heard.get(role, 0) < self._heard[MASTER]]
        return (silent or behind or [RECORDER])[0]


def _is_stopped(pid: int) -> bool:
    """Whether a process stands still by SIGSTOP or the like."""
    try:
        return (Path("/proc") / str(pid) / "stat").read_text().rpartition(")")[2].split()[0] in "Tt"
    except (OSError, IndexError):
        return False
