"""Stamped inputs of one node, collected until a step has all of them (docs/lockstep.md)."""

from __future__ import annotations

from enum import Enum

from ev_msgs_py.contract.frame import Frame

_KEPT_AHEAD = 8  # incomplete steps that a node keeps at most


class Arrival(Enum):
    """What a message turned out to be."""

    NEW = "it is kept for its step"
    REPEATED = "it is known already: somebody misses our answer"
    OLD = "its step is over and answered, and so is the next"
    GAP = "it is too far ahead, or between two steps: it cannot belong to this run of steps"
    RESTART = "time went back to zero: a new run begins"


class Step:
    """The inputs of one step: their numbers in a frame, and which signals have come."""

    __slots__ = ("came", "frame")

    def __init__(self) -> None:
        self.frame = Frame()
        self.came: set[type] = set()


class Inbox:
    """Collects the numbers of one message of each kind per stamp, in a frame.

    `reads` are the signal types of one step, `period` is the step in nanoseconds. A node that has not stepped yet
    takes any stamp as its first; from then on steps follow each other without a gap, unless `may_skip` (realtime,
    where the master does not wait). A message may run ahead of the next step by one more step, because the writers
    do not wait for each other within a step. Stamp zero of one of the `heralds` after other stamps begins a new run.
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
        self._pending: dict[int, Step] = {}
        self._missing: tuple[type, ...] | None = None  # None where it has to be found anew

    def offer(self, kind: type, stamp: int) -> Arrival:
        """Judge a message; of a new one, and of one that begins a new run, the numbers belong into `frame_at`."""
        last = self.last
        if last is not None:
            ahead = stamp - last
            if stamp == 0 and ahead < 0 and kind in self._heralds:
                self.expect(0)
                self._keep(kind, stamp)
                return Arrival.RESTART
            if ahead <= 0:
                return Arrival.OLD if ahead else Arrival.REPEATED
            if ahead % self.period or (ahead > 2 * self.period and not self._may_skip):
                return Arrival.GAP
        return self._keep(kind, stamp)

    def frame_at(self, stamp: int) -> Frame:
        """The frame of a step that waits for inputs; one that nobody waits for any more where it was given up."""
        step = self._pending.get(stamp)
        return Frame() if step is None else step.frame

    def _keep(self, kind: type, stamp: int) -> Arrival:
        step = self._pending.get(stamp)
        if step is None:
            step = self._pending[stamp] = Step()
        elif kind in step.came:
            return Arrival.REPEATED
        step.came.add(kind)
        self._missing = None
        if len(self._pending) > _KEPT_AHEAD:
            del self._pending[min(self._pending)]
            self._missing = None
        return Arrival.NEW

    def expect(self, stamp: int) -> None:
        """Forget everything; the next step is the one of this stamp."""
        self.last = stamp - self.period
        self._pending.clear()
        self._missing = None

    def complete(self) -> int | None:
        """Stamp of the newest step that has all its inputs, None if there is none."""
        if not self._may_skip and self.last is not None:
            missing = self._missing
            if missing is None:
                missing = self.missing()
            return None if missing else self.last + self.period
        for stamp in sorted(self._pending, reverse=True):
            if len(self._pending[stamp].came) == len(self.reads):
                return stamp
        return None

    def take(self, stamp: int) -> Frame:
        """The inputs of a complete step; older ones are forgotten."""
        inputs = self._pending.pop(stamp).frame
        if self._pending:
            for old in [s for s in self._pending if s < stamp]:
                del self._pending[old]
        self.last = stamp
        self._missing = None
        return inputs

    def missing(self) -> tuple[type, ...]:
        """The signal types that the next step still waits for, in order of `reads`; all before the first step."""
        if self._missing is None:
            self._missing = self.reads if self.last is None else self._find_missing(self.last)
        return self._missing

    def _find_missing(self, last: int) -> tuple[type, ...]:
        due = last + self.period
        step, after = self._pending.get(due), self._pending.get(due + self.period)
        came = step.came if step is not None else set()
        if not self._followed:
            return tuple([kind for kind in self.reads if kind not in came])
        gone_on = after.came if after is not None else set()
        return tuple(
            [kind for kind in self.reads if kind not in came or (kind in self._followed and kind not in gone_on)]
        )
