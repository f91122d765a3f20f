"""Whether the nodes of a run begin, or have lost sight of each other, for once or for good."""

from __future__ import annotations

import math
import time

from ev_msgs_py.nodes.time_of_day import SetBack, ahead
from ev_sim.running.outcome import RunFailed
from ev_sim.running.told import Told

_TO_BEGIN = 3.0  # s for the first step behind a time of day that was set back; nodes tell each other things again
_AT_ALL = 300.0  # s for the first step of our own nodes: one that was edited compiles its plant on a busy machine


class Beginning:
    """Watches a run up to its first step; made before its nodes are, and `is_missed` is to be asked often.

    It is `patient` with nodes of others, which may load for long, or stand at a breakpoint.
    The middleware keeps what processes tell about themselves in the order of the time of day. Where that is set back
    while they find each other, one of them may never learn what another one has told. Processes that are started
    behind it do.
    """

    def __init__(self, patient: bool = False) -> None:
        self._set_back = SetBack(ahead())
        self._deadline = math.inf
        self._given_up = math.inf if patient else time.monotonic() + _AT_ALL

    def is_missed(self, told: Told) -> bool:
        """Whether the time of day was set back and no step was taken in the seconds behind it.

        RunFailed if no step has been taken for so long that there will be none.
        """
        if told.time > 0 or told.rests:
            self._given_up = math.inf
        if time.monotonic() > self._given_up:
            raise RunFailed(f"no step was taken within {_AT_ALL:g} s: the nodes do not find or answer each other")
        if self._set_back.is_seen() or (told.rests and self._deadline < math.inf):
            self._deadline = time.monotonic() + _TO_BEGIN
        if told.time > 0:
            self._deadline = math.inf
        return time.monotonic() > self._deadline
