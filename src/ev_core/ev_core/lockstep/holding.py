"""The inputs of a node in real time: for a while the newest replace those that do not come."""

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
    """An inbox that may leave steps out, and holds the newest inputs for those that do not come.

    Without that one lost message would stop nodes that read each other for ever. A step is also
    complete when one of the `pacing` inputs of a later step is there. Where inputs are `neutral` as
    zero they may never have come. Else none of them may be older than `HELD`: a node that still
    answered to a driver that is gone would repeat the last torque for ever, each time with a new
    stamp.
    """

    def __init__(self, inputs: Inputs, pacing: frozenset[type], neutral: bool) -> None:
        super().__init__(inputs, may_skip=True)
        self._pacing = pacing
        self._neutral = neutral
        self.held = HeldInputs(inputs.reads)
        self._paced = -1  # newest stamp of the pacing ones

    def expect(self, stamp: int) -> None:
        """Forget everything; the next step is the one of this stamp, or any later one."""
        super().expect(stamp)
        self.held.clear()
        self._paced = -1

    def offer(self, kind: type, stamp: int, numbers: Sequence[float]) -> Arrival:
        """Judge a message; keep its numbers if it is new, and hold them if they are the newest.

        Those of a step that was taken without them are held for the next one, too: a sender may be
        late each time.
        """
        arrival = super().offer(kind, stamp, numbers)
        last = self.last
        # Stamps of another run lie between those of this one.
        is_of_run = last is None or (stamp - last) % self.period == 0
        if arrival is not Arrival.GAP and stamp > self.held.stamp_of(kind) and is_of_run:
            if arrival is Arrival.REPEATED:
                # It is none: the step has been taken without it.
                arrival = Arrival.OLD
            self.held.keep(kind, stamp, numbers)
            if kind in self._pacing:
                self._paced = max(self._paced, stamp)
        return arrival

    def complete(self) -> int | None:
        """Stamp of the newest step that has all its inputs, or that shall wait no longer.

        None if there is none.
        """
        whole = super().complete()
        if whole is not None:
            return whole
        # A step waits no longer once a pacing input of a later one is there: the graph has gone on.
        held: list[int] = []
        for stamp, came in self.waiting.items():
            if stamp < self._paced and self._may_hold(stamp, came):
                held.append(stamp)
        return max(held, default=None)

    def _may_hold(self, stamp: int, came: int) -> bool:
        """Return whether a step can be taken with held inputs for those that have not come."""
        if self._neutral:
            return True
        # A kind that never came has the stamp -1, which is older than any.
        oldest = max(stamp - max(HELD, 2 * self.period), 0)
        for i, kind in enumerate(self.reads):
            has_come = came >> i & 1
            if not has_come and self.held.stamp_of(kind) < oldest:
                return False
        return True

    def take(self, stamp: int) -> Frame:
        """The inputs of a step, held where they have not come; older ones are forgotten."""
        # Before `take`, which forgets what has come for the step.
        came = come_for(self.steps, stamp)
        inputs = super().take(stamp)
        for i, kind in enumerate(self.reads):
            if not came >> i & 1:
                inputs.copy(self.held.frame, PLACES[kind])
        return inputs
