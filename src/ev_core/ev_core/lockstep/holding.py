"""The inputs of a node in real time, where the newest ones replace, for a while, those that do not come."""

from __future__ import annotations

from array import array
from collections.abc import Sequence

from ev_core.lockstep.inbox import Arrival, Inbox, Inputs, come_for
from ev_msgs_py.contract.frame import PLACES, Frame

HELD = 100_000_000  # age of an input up to which a node answers to it [ns]; at least two periods


class HeldInputs:
    """The numbers of the newest message of each kind, in a frame, and its stamp."""

    def __init__(self, reads: tuple[type, ...]) -> None:
        self._reads = reads
        self.clear()

    def clear(self) -> None:
        """Forget everything."""
        self.frame = Frame()
        self._stamps: dict[type, int] = {}

    def keep(self, kind: type, stamp: int, numbers: Sequence[float]) -> None:
        """Keep a message."""
        self._stamps[kind] = stamp
        self.frame.numbers[PLACES[kind]] = array("d", numbers)

    def stamp_of(self, kind: type) -> int:
        """The stamp of the message of a kind, -1 if there is none."""
        return self._stamps.get(kind, -1)

    @property
    def missing(self) -> tuple[type, ...]:
        """The kinds without any message."""
        return tuple(kind for kind in self._reads if kind not in self._stamps)


class HoldingInbox(Inbox):
    """An inbox in which steps may be left out, and in which the newest inputs replace those that do not come.

    Without that one lost message would stop nodes that read each other for ever. A step is also
    complete when one of the `pacing` inputs of a later step is there. Where inputs are `neutral` as
    zero they may never have come. Else none of them may be older than `HELD`: a node that still
    answered to a driver that is gone would repeat the last torque for ever, each time with a new
    stamp.
    """

    def __init__(self, inputs: Inputs, pacing: frozenset[type], neutral: bool) -> None:
        super().__init__(inputs, may_skip=True)
        self._pacing, self._neutral = pacing, neutral
        self.held = HeldInputs(inputs.reads)
        self._paced = -1  # newest stamp of the pacing ones

    def expect(self, stamp: int) -> None:
        """Forget everything; the next step is the one of this stamp, or any later one."""
        super().expect(stamp)
        self.held.clear()
        self._paced = -1

    def offer(self, kind: type, stamp: int, numbers: Sequence[float]) -> Arrival:
        """Judge a message, keep its numbers if it is new or begins a new run, and hold them if they are the newest.

        Those of a step that was taken without them are held for the next one, too: a sender may be
        late each time.
        """
        arrival, last = super().offer(kind, stamp, numbers), self.last
        is_of_run = last is None or (stamp - last) % self.period == 0
        if arrival is not Arrival.GAP and stamp > self.held.stamp_of(kind) and is_of_run:
            if arrival is Arrival.REPEATED:  # it is not: the step has been taken without it
                arrival = Arrival.OLD
            self.held.keep(kind, stamp, numbers)
            if kind in self._pacing:
                self._paced = max(self._paced, stamp)
        return arrival

    def complete(self) -> int | None:
        """Stamp of the newest step that has all its inputs, or that shall wait no longer; None if there is none."""
        whole = super().complete()
        if whole is not None:
            return whole
        held = (
            stamp
            for stamp, came in self.waiting.items()
            if stamp < self._paced and self._may_hold(stamp, came)
        )
        return max(held, default=None)

    def _may_hold(self, stamp: int, came: int) -> bool:
        """Return whether a step can be taken with the held inputs in place of those that have not come for it."""
        oldest = stamp - max(HELD, 2 * self.period)
        stamps = (
            self.held.stamp_of(kind) for i, kind in enumerate(self.reads) if not came >> i & 1
        )
        return self._neutral or all(each >= max(oldest, 0) for each in stamps)

    def take(self, stamp: int) -> Frame:
        """The inputs of a step, held where they have not come; older ones are forgotten."""
        came = come_for(self.steps, stamp)
        inputs = super().take(stamp)
        for i, kind in enumerate(self.reads):
            if not came >> i & 1:
                inputs.copy(self.held.frame, PLACES[kind])
        return inputs
