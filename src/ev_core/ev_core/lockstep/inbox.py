"""The inbox of a node, which collects the inputs of each step (docs/lockstep.md).

How it works: every message carries the stamp of its instant. `judged` decides by the stamp whether
a message is new, repeated, old, ahead of its time, or of a new run. A new one is kept in a row of
numbers for its step, and the step is complete when all its inputs have come. The protocol is one
text: it is interpreted here, and compiled in `node_loop/steps.py`. Both work on the same `Steps`.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Sequence
from enum import Enum
from typing import Any, NamedTuple

import numpy as np

from ev_msgs_py.compilable import compilable
from ev_msgs_py.contract.frame import PLACES, SIZE, Frame
from ev_msgs_py.contract.stamps import RUN, RUNS

ROWS = 8  # steps with kept inputs at most
NEVER = -(1 << 62)  # the stamp of an answer or step that has not been yet
# Places in `Steps.done`: the last step, the last answer, the answer before it
LAST, ANSWER, BEFORE = range(3)


class Arrival(Enum):
    """Judgement of a message."""

    NEW = "it is kept for its step"
    REPEATED = "duplicate: a reader has missed our answer"
    OLD = "its step is over and answered, and so is the next; or it is of another run"
    GAP = "it is too far ahead, or between two steps: it cannot belong to this run of steps"
    RESTART = "time went back to zero, or it is the first instant of a later run: a new run begins"


# Compiled code knows an arrival by its place.
_ARRIVALS = tuple(Arrival)
NEW, REPEATED, OLD, GAP, RESTART = range(len(_ARRIVALS))


class Steps(NamedTuple):
    """The steps of a node in integers.

    Sets of its inputs are bits of one integer, the first input is the lowest bit. The inputs of a
    step are in row `stamp // period % ROWS` of the frames. An answer is in the row of its inputs
    or, of a node that integrates, in one of two rows behind all.
    """

    done: Any  # (3,) stamps, NEVER where there is none
    stamps: Any  # (ROWS,) of the step with its inputs in the row
    came: Any  # (ROWS,) the inputs that have come for that step
    inputs: int  # all that a step needs
    heralds: int  # those with writers that need this node's step before they go on to the next one
    followed: int  # those that a step needs of the next step as well
    period: int  # [ns]
    # stamp of an answer above that of its step [ns]: the period if the node integrates, else 0
    lead: int
    may_skip: int  # 1 in real time, where the master does not wait


class Inputs(NamedTuple):
    """The inputs of a node, and their relation to its steps."""

    reads: tuple[type, ...]  # signal types of one step
    period: int  # of the step [ns]
    # with writers that need this node's step before they publish the next one
    heralds: frozenset[type] = frozenset()
    followed: frozenset[type] = frozenset()  # also needed of the next step
    lead: int = 0  # stamp of an answer above that of its step [ns]


@compilable
def row_of(steps: Any, stamp: int) -> int:
    """The row of the inputs of a step."""
    row: int = stamp // steps.period % ROWS
    return row


@compilable
def row_of_answer(steps: Any, stamp: int) -> int:
    """The row of the answer for an instant."""
    number = stamp // steps.period
    row: int = ROWS + number % 2 if steps.lead else number % ROWS
    return row


@compilable
def come_for(steps: Any, stamp: int) -> Any:
    """The inputs that have come for a step."""
    row = stamp // steps.period % ROWS
    return steps.came[row] if steps.stamps[row] == stamp else 0


@compilable
def missing(steps: Any) -> Any:
    """The inputs that the step that is due lacks, of itself or of the step that follows it."""
    due = steps.done[LAST] + steps.period
    lacking = steps.inputs & ~come_for(steps, due)
    if steps.followed:
        return lacking | steps.followed & ~come_for(steps, due + steps.period)
    return lacking


@compilable
def judged(steps: Any, stamp: int, i: int) -> Any:
    """Judge a message of an input: NEW, REPEATED, OLD, GAP or RESTART."""
    last, period = steps.done[LAST], steps.period
    ahead, above = stamp - last, stamp % period
    if above % RUN != 0 or above >= RUNS:
        return GAP  # between the instants of every run
    # The next step, and the first one, need no further look: most messages are for these.
    if ahead != period and last != NEVER:
        is_herald = steps.heralds >> i & 1 != 0
        if (
            is_herald
            and ahead != 0
            and (stamp == 0 or (last % period < stamp < RUNS and stamp % RUN == 0))
        ):
            # of a later run, or of a master that is another one and counts from zero
            return RESTART
        if ahead % period != 0:
            return OLD  # of another run
        if ahead <= 0:
            return OLD if ahead < 0 else REPEATED
        # A writer that needs our step cannot be ahead of it, unless a message of it was lost.
        leaves_out = is_herald and come_for(steps, last + period) >> i & 1 == 0
        if steps.may_skip == 0 and (ahead > 2 * period or leaves_out):
            return GAP
    return REPEATED if come_for(steps, stamp) >> i & 1 != 0 else NEW


@compilable
def keep(steps: Any, stamp: int, i: int) -> Any:
    """Note that an input has come for a step, and return the row for its numbers."""
    row = stamp // steps.period % ROWS
    steps.came[row] = come_for(steps, stamp) | 1 << i
    steps.stamps[row] = stamp
    return row


@compilable
def note_answer(steps: Any, stamp: int) -> None:
    """Note that the node has answered for an instant."""
    steps.done[BEFORE] = steps.done[ANSWER]
    steps.done[ANSWER] = stamp


class Inbox:
    """Collects the numbers of one message of each kind per stamp, in a frame.

    A node that has not stepped yet takes any step as its first; from then on steps follow each
    other without a gap, unless `may_skip` (realtime, where the master does not wait). A message may
    run ahead of the next step by one more step, because the writers do not wait for each other
    within a step.

    The n-th run after a reset has stamps of n times `RUN` above its instants: a message that is
    still under way of a run before fits to no step. The first stamp of a later run, or stamp zero
    after others, of one of the heralds begins a new run. A step is complete when all its inputs are
    there, and of the `followed` ones those of the step after it as well. Compiled code finds all
    numbers that last at `addresses`.
    """

    def __init__(self, inputs: Inputs, may_skip: bool = False) -> None:
        self.reads = inputs.reads
        self.period = inputs.period
        self._place = {kind: i for i, kind in enumerate(inputs.reads)}
        self._kinds: dict[int, tuple[type, ...]] = {}  # by their bits
        self._block = np.zeros(3 + 2 * ROWS, np.int64)
        block: Any = memoryview(self._block)  # type: ignore[arg-type]  # unknown to mypy
        self.steps = Steps(
            done=block[:3],
            stamps=block[3 : 3 + ROWS],
            came=block[3 + ROWS :],
            inputs=self._bits(inputs.reads),
            heralds=self._bits(inputs.heralds),
            followed=self._bits(inputs.followed),
            period=inputs.period,
            lead=inputs.lead,
            may_skip=int(may_skip),
        )
        # Two rows more for the answers of a node that integrates: the last one and the one before.
        self._numbers = np.zeros((ROWS + 2, SIZE))
        self.frames: list[Frame] = [Frame.of(row) for row in self._numbers]
        self.addresses = self._block.ctypes.data, self._numbers.ctypes.data
        self._block[: 3 + ROWS] = NEVER

    def _bits(self, kinds: Iterable[type]) -> int:
        return sum(1 << self._place[kind] for kind in kinds if kind in self._place)

    def offer(self, kind: type, stamp: int, numbers: Sequence[float]) -> Arrival:
        """Judge a message, and keep its numbers if it is new or begins a new run."""
        i, steps = self._place[kind], self.steps
        arrival: int = judged(steps, stamp, i)
        if arrival == RESTART:
            self.expect(stamp)
        if arrival in (NEW, RESTART):
            self.frames[keep(steps, stamp, i)].numbers[PLACES[kind]] = array("d", numbers)
        return _ARRIVALS[arrival]

    @property
    def last(self) -> int | None:
        """The stamp of the last step; None before the first one."""
        last = int(self.steps.done[LAST])
        return None if last == NEVER else last

    @property
    def run(self) -> int:
        """Difference between the stamps of this run and their instants [ns]."""
        last = self.last
        return 0 if last is None else last % self.period

    @property
    def is_at_zero(self) -> bool:
        """True if a message of time zero has come, and no later step was taken."""
        return self.last == 0 or bool(self.steps.done[LAST] < 0 and come_for(self.steps, 0))

    def expect(self, stamp: int) -> None:
        """Forget everything; the next step is the one of this stamp."""
        self._block[3 : 3 + ROWS] = NEVER
        self.steps.done[LAST] = stamp - self.period

    @property
    def waiting(self) -> dict[int, int]:
        """The steps yet to be taken, by stamp, and the bits of inputs that have come."""
        steps = self.steps
        found: dict[int, int] = {}
        for stamp, came in zip(steps.stamps, steps.came, strict=True):
            if stamp > steps.done[LAST]:
                found[stamp] = came
        return found

    def complete(self) -> int | None:
        """Stamp of the newest step that has all its inputs, None if there is none."""
        last = self.steps.done[LAST]
        if last == NEVER or self.steps.may_skip:
            whole = [each for each, came in self.waiting.items() if came == self.steps.inputs]
            return max(whole, default=None)
        return None if missing(self.steps) else last + self.period

    def take(self, stamp: int) -> Frame:
        """The inputs of a complete step; older ones are forgotten."""
        self.steps.done[LAST] = stamp
        return self.frames[row_of(self.steps, stamp)]

    def missing(self) -> tuple[type, ...]:
        """The signal types that the next step still waits for, in order of `reads`.

        Before the first step these are all.
        """
        lacking = self.steps.inputs if self.steps.done[LAST] == NEVER else missing(self.steps)
        # It is asked for often while a node waits, and always with the same few sets.
        found = self._kinds.get(lacking)
        if found is None:
            found = tuple(kind for i, kind in enumerate(self.reads) if lacking >> i & 1)
            self._kinds[lacking] = found
        return found
