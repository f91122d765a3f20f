"""Stamped inputs of one node, collected until a step has all of them, or held in real time (docs/lockstep.md)."""

from __future__ import annotations

from array import array
from collections.abc import Sequence, Set
from enum import Enum

from ev_msgs_py.contract.frame import PLACES, Frame
from ev_msgs_py.contract.stamps import RUN, RUNS

_KEPT_AHEAD = 8  # incomplete steps that a node keeps at most
_NONE: Set[type] = frozenset()


class Arrival(Enum):
    """What a message turned out to be."""

    NEW = "it is kept for its step"
    REPEATED = "it is known already: somebody misses our answer"
    OLD = "its step is over and answered, and so is the next; or it is of another run"
    GAP = "it is too far ahead, or between two steps: it cannot belong to this run of steps"
    RESTART = "time went back to zero, or it is the first instant of a later run: a new run begins"


class Inbox:
    """Collects the numbers of one message of each kind per stamp, in a frame.

    `reads` are the signal types of one step, `period` is the step in nanoseconds. A node that has not stepped yet
    takes any stamp as its first; from then on steps follow each other without a gap, unless `may_skip` (realtime,
    where the master does not wait). A message may run ahead of the next step by one more step, because the writers
    do not wait for each other within a step; the `heralds` need this node's step before they speak of the next one.

    The n-th run after a reset has stamps of n times `RUN` above its instants: what is still under way of a run before
    is of no step. The first stamp of a later run, or stamp zero after others, of one of the heralds begins a new run.
    A step is complete when all its inputs are there, and of the `followed` ones those of the step after it as well.
    """

    def __init__(
        self,
        reads: tuple[type, ...],
        heralds: frozenset[type],
        period: int,
        may_skip: bool = False,
        followed: frozenset[type] = frozenset(),
    ) -> None:
        self.reads = reads
        self._heralds = heralds
        self._followed = followed
        self.period = period
        self.last: int | None = None
        self._may_skip = may_skip
        self.pending: dict[int, tuple[Frame, set[type]]] = {}  # inputs by stamp, and which have come
        self._missing: tuple[type, ...] | None = None  # None where it has to be found anew

    def offer(self, kind: type, stamp: int, numbers: Sequence[float]) -> Arrival:
        """Judge a message, and keep its numbers if it is new or begins a new run."""
        arrival, last = Arrival.NEW, self.last
        if last is not None and stamp != last + self.period:
            ahead = stamp - last
            if ahead and self._begins_run(kind, stamp):
                self.expect(stamp)
                arrival = Arrival.RESTART
            elif not self._is_of_run(stamp):
                number = stamp % self.period
                return Arrival.GAP if number % RUN or number >= RUNS else Arrival.OLD
            elif ahead <= 0:
                return Arrival.OLD if ahead else Arrival.REPEATED
            elif self._leaves_out(kind, stamp):
                return Arrival.GAP
        step = self.pending.get(stamp)
        if step is None:
            step = self.pending[stamp] = Frame(), set()
            if len(self.pending) > _KEPT_AHEAD:
                del self.pending[min(self.pending)]
        inputs, came = step
        if kind in came:
            return Arrival.REPEATED
        came.add(kind)
        self._missing = None
        inputs.numbers[PLACES[kind]] = array("d", numbers)
        return arrival

    @property
    def run(self) -> int:
        """What stamps are above the instants that they mean [ns]."""
        return 0 if self.last is None else self.last % self.period

    @property
    def is_at_zero(self) -> bool:
        """Whether something of time zero has come, and nothing has been stepped behind it."""
        return self.last == 0 or 0 in self.pending

    def _is_of_run(self, stamp: int) -> bool:
        """Whether a stamp is that of an instant of this run; of any before the first step."""
        return self.last is None or (stamp - self.last) % self.period == 0

    def _begins_run(self, kind: type, stamp: int) -> bool:
        """Whether a message is of a later run, or of a master that is another one and counts from zero."""
        return kind in self._heralds and (stamp == 0 or (self.run < stamp < RUNS and stamp % RUN == 0))

    def _leaves_out(self, kind: type, stamp: int) -> bool:
        """Whether a message can be of none of the next steps: it is too far ahead, or a herald leaves out a step."""
        if self._may_skip or self.last is None:
            return False
        ahead = stamp - self.last
        return ahead > 2 * self.period or (kind in self._heralds and kind not in self._came(self.last + self.period))

    def expect(self, stamp: int) -> None:
        """Forget everything; the next step is the one of this stamp."""
        self.last = stamp - self.period
        self.pending.clear()
        self._missing = None

    def go_on(self, last: int, pending: dict[int, tuple[Frame, set[type]]]) -> None:
        """Steps up to `last` were taken elsewhere, and these inputs are there for the next ones."""
        self.last, self.pending, self._missing = last, pending, None

    def complete(self) -> int | None:
        """Stamp of the newest step that has all its inputs, None if there is none."""
        if self.last is None or self._may_skip:
            whole = [stamp for stamp, (_, came) in self.pending.items() if len(came) == len(self.reads)]
            return max(whole, default=None)
        due = self.last + self.period
        if len(self._came(due)) < len(self.reads) or not self._followed <= self._came(due + self.period):
            return None
        return due

    def _came(self, stamp: int) -> Set[type]:
        """The signals of a step that are there."""
        step = self.pending.get(stamp)
        return _NONE if step is None else step[1]

    def take(self, stamp: int) -> Frame:
        """The inputs of a complete step; older ones are forgotten."""
        inputs, _ = self.pending.pop(stamp)
        if self.pending:
            for old in [s for s in self.pending if s < stamp]:
                del self.pending[old]
        self.last = stamp
        self._missing = None
        return inputs

    def missing(self) -> tuple[type, ...]:
        """The signal types that the next step still waits for, in order of `reads`; all before the first step."""
        if self._missing is None:
            self._missing = self.reads if self.last is None or not self.pending else self._find_missing(self.last)
        return self._missing

    def _find_missing(self, last: int) -> tuple[type, ...]:
        came = self._came(last + self.period)
        if self._followed:
            came = came - (self._followed - self._came(last + 2 * self.period))
        return tuple([kind for kind in self.reads if kind not in came])


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
