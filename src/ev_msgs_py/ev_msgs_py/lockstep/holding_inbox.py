"""Stamped inputs of one node in real time, where nobody waits and nobody repeats."""

from __future__ import annotations

from array import array
from collections.abc import Sequence

from ev_msgs_py.contract.frame import PLACES, Frame
from ev_msgs_py.lockstep.inbox import Arrival, Inbox


class HoldingInbox(Inbox):
    """An inbox in which steps may be left out, and in which the newest inputs stand for those that do not come.

    Without that one lost message would stop nodes that read each other for ever. A step is also complete when one of
    the `pacing` inputs of a later step is there; inputs that have never come must be `neutral` as zero for that.
    """

    def __init__(
        self, reads: tuple[type, ...], heralds: frozenset[type], period: int, pacing: frozenset[type], neutral: bool
    ) -> None:
        super().__init__(reads, heralds, period, may_skip=True)
        self._pacing, self._neutral = pacing, neutral
        self._forget()

    def _forget(self) -> None:
        self._held = Frame()
        self._heard: dict[type, int] = {}  # newest stamp by kind
        self._paced = -1  # newest stamp of the pacing ones

    def expect(self, stamp: int) -> None:
        """Forget everything; the next step is the one of this stamp, or any later one."""
        super().expect(stamp)
        self._forget()

    def offer(self, kind: type, stamp: int, numbers: Sequence[float]) -> Arrival:
        """Judge a message, keep its numbers if it is new or begins a new run, and hold them if they are the newest.

        Those of a step that was taken without them are held for the next one, too: who is late each time is heard.
        """
        arrival = super().offer(kind, stamp, numbers)
        if arrival is not Arrival.GAP and stamp > self.newest(kind) and self._is_of_run(stamp):
            if arrival is Arrival.REPEATED:  # it is not: the step has been taken without it
                arrival = Arrival.OLD
            self._heard[kind] = stamp
            self._held.numbers[PLACES[kind]] = array("d", numbers)
            if kind in self._pacing:
                self._paced = max(self._paced, stamp)
        return arrival

    def newest(self, kind: type) -> int:
        """The stamp of the newest message of a kind that has come, -1 if there is none."""
        return self._heard.get(kind, -1)

    def complete(self) -> int | None:
        """Stamp of the newest step that has all its inputs, or that shall wait no longer; None if there is none."""
        whole = super().complete()
        if whole is not None or not (self._neutral or len(self._heard) == len(self.reads)):
            return whole
        return max((stamp for stamp in self.pending if stamp < self._paced), default=None)

    def take(self, stamp: int) -> Frame:
        """The inputs of a step, held where they have not come; older ones are forgotten."""
        missing = [PLACES[kind] for kind in self.reads if kind not in self._came(stamp)]
        inputs = super().take(stamp)
        for place in missing:
            inputs.numbers[place] = self._held.numbers[place]
        return inputs
