"""Which node of a run that stands still does not answer, by what the nodes tell the runner of each other."""

from __future__ import annotations

import time
from collections.abc import Mapping
from pathlib import Path

from ev_msgs_py.contract.roles import MASTER, RECORDER
from ev_sim.running.told import Told

_HEARKEN = 0.6  # s for nodes to say, every 0.2 s, for whom they wait
_TO_COME_UP = 10.0  # s that nodes may take to start


class Hanging:
    """Names the node that a run waits for when nothing has gone on for some wall time; `look` is to be called often.

    Who waits says for whom; so it is the one at the end of that chain, who says nothing. A chain that comes back ends
    with who cannot be heard: he waits for what the others wait to have from him. In lockstep all wait for the master,
    and he waits for one of them. In real time he waits for nobody, and the recorder is the one to ask.
    """

    def __init__(self, told: Told, pids: Mapping[str, int], patience: float, realtime: bool) -> None:
        self._told, self._pids, self._realtime = told, dict(pids), realtime
        self._wait = max(patience - 0.2, _HEARKEN)
        self._since = time.monotonic()
        self._time = told.time
        self._named = False

    def look(self) -> str | None:
        """One line on who does not answer, once for each time that the run stands still."""
        now = time.monotonic()
        waits_for_its_time = self._told.waits_for(MASTER, _HEARKEN) == []  # a step may take seconds at a slow pace
        if self._told.time != self._time or self._told.rests or waits_for_its_time:
            self._time, self._since, self._named = self._told.time, now, False
        elif not self._named and now - self._since > (self._wait if self._time else _TO_COME_UP):
            self._named = True
            stopped = [name for name, pid in self._pids.items() if _is_stopped(pid)]
            if stopped:
                return f"stopped by a signal: {', '.join(stopped)}, at {self._time:g} s of simulated time"
            return f"node {self._who()} does not answer, at {self._time:g} s of simulated time"
        return None

    def has_ended(self, name: str) -> None:
        """A node has come to its end: it need not answer any more."""
        self._pids.pop(name, None)

    def _who(self) -> str:
        if MASTER not in self._pids:
            return RECORDER
        chain = [RECORDER if self._realtime else MASTER]
        while whom := [each for each in self._told.waits_for(chain[-1], _HEARKEN) or () if each in self._pids]:
            if whom[0] in chain:
                break
            chain.append(whom[0])
        return chain[-1]


def _is_stopped(pid: int) -> bool:
    """Whether a process stands still by SIGSTOP or the like."""
    try:
        return (Path("/proc") / str(pid) / "stat").read_text().rpartition(")")[2].split()[0] in "Tt"
    except (OSError, IndexError):
        return False
