"""The part of a node in lockstep, without ROS (docs/lockstep.md).

How it works: stamped signals go into the inbox. When the inbox has all inputs of the step that is
due, the part takes the step, and its answer bears the stamp of the inputs or, of a part that
integrates, that of the next instant. A message that has come already shows that its sender has
missed an answer: the last answers are sent again. Nothing is ever sent by a clock.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from ev_core.lockstep.graph import arrival_order, sequence, step_order, writers
from ev_core.lockstep.holding import HoldingInbox
from ev_core.lockstep.inbox import (
    ANSWER,
    BEFORE,
    NEVER,
    Arrival,
    Inbox,
    Inputs,
    note_answer,
    row_of,
    row_of_answer,
)
from ev_core.methods.method_record import Method
from ev_core.methods.part import Part
from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.frame import TIME, Frame
from ev_msgs_py.contract.roles import INTEGRATED, MASTER, ROLES, RoleKind

WRITERS = writers(ROLES)


class Answer(NamedTuple):
    """The output of a node for one instant: the numbers of what it writes, in a frame."""

    stamp: int
    frame: Frame


_ORDER = {role: place for place, role in enumerate(sequence(ROLES))}
_ARRIVAL = {role: place for place, role in enumerate(arrival_order(ROLES, MASTER))}
_FIRST_TO_ANSWER = ROLES[next(role for role in step_order(ROLES))]


def arrival_place(signal: type) -> tuple[int, int, int]:
    """Place of a signal among all of one instant in the order of their arrival.

    The higher one arrives later. A role publishes those of its signals first that the first role to
    answer needs most.
    """
    writer, needed = WRITERS[signal], _FIRST_TO_ANSWER.reads
    urgency = needed.index(signal) if signal in needed else len(needed)
    return _ARRIVAL[writer], urgency, ROLES[writer].may_write.index(signal)


def upstream_signals(role: str) -> frozenset[type]:
    """The signals of the roles before this one within a step.

    A repeated one of these asks for a repeated answer. To repeat one for a role behind would be
    worse than useless: two nodes that read each other would repeat their answers for ever.
    """
    return frozenset(signal for signal, writer in WRITERS.items() if _ORDER[writer] < _ORDER[role])


class Stepper:
    """Steps the part of a method exactly once per stamp, as soon as all its inputs are there.

    `make` gives a new part, at rest; `period` is the step in nanoseconds. A part that answers at
    once answers with the stamp of its inputs. One that integrates answers with the stamp of the
    next step, and with its initial state for as long as it has not stepped. In real time steps
    `may_skip`.
    """

    def __init__(
        self, method: Method, make: Callable[[], Part], period: int, may_skip: bool = False
    ) -> None:
        self.reads = tuple(sorted(method.inputs, key=arrival_place))
        self.integrates = ROLES[method.role].kind is RoleKind.INTEGRATES
        self.upstream = upstream_signals(method.role)
        of_master = frozenset(ROLES[MASTER].writes)
        # An integrating writer repeats its last two answers, so its stamp zero may be a late
        # repetition.
        heralds = of_master | {s for s in self.upstream if s not in INTEGRATED}
        # The master repeats no other state than the present one, so it must not leave a node
        # behind: it goes on when the others that integrate have done so too. They have all answers,
        # and these needed the master's state.
        followed: frozenset[type] = frozenset()
        if method.role == MASTER and not may_skip:
            followed = frozenset(s for s in self.reads if s in INTEGRATED)
        # The others that integrate publish the next instant, from which nothing follows for the
        # inputs of this one.
        self._pacing = frozenset(s for s in self.reads if s in of_master or s not in INTEGRATED)
        lead = period if self.integrates else 0
        inputs = Inputs(self.reads, period, heralds, followed, lead)
        if may_skip:
            self.inbox: Inbox = HoldingInbox(inputs, self._pacing, neutral=self.integrates)
        else:
            self.inbox = Inbox(inputs)
        self._steps = self.inbox.steps
        self._done = self._steps.done
        self._frames = self.inbox.frames
        self.period = period
        self._make = make
        self._at_rest = True
        self.part = make()

    @property
    def answer(self) -> Answer | None:
        """The last answer of this run; its frame is that of a later one after some steps."""
        return self._answer(ANSWER)

    @property
    def answered(self) -> int:
        """The stamp of that answer, NEVER if there is none: it takes a third of the time."""
        stamp: int = self._done[ANSWER]
        return stamp

    def _answer(self, which: int) -> Answer | None:
        stamp = self._done[which]
        return None if stamp == NEVER else Answer(stamp, self.frame_of(stamp))

    @property
    def under_way(self) -> bool:
        """True once a step has been taken since the run began."""
        return not self._at_rest and self.inbox.last is not None

    def answers_to(self, kind: type, stamp: int, arrival: Arrival) -> Sequence[Answer]:
        """Answers to a message that has arrived: that of a step, or recent answers again."""
        # Nearly all messages are of this kind, so they come first.
        if arrival is Arrival.NEW and not self._at_rest:
            answer = self.step()
            return () if answer is None else (answer,)
        if arrival is Arrival.RESTART:
            self._begin_anew()
        answers: list[Answer] = []
        if arrival is Arrival.REPEATED and kind in self.upstream:
            answers += self._recent_answers()
        if self.integrates and self._at_rest and kind in self._pacing and self._must_begin(stamp):
            if self.answered != NEVER:
                # Of another run, which may begin with other values.
                self._begin_anew()
            answers.append(self._start(stamp))
        answer = self.step()
        if answer is not None:
            answers.append(answer)
        return answers

    def _must_begin(self, stamp: int) -> bool:
        """Return whether others still need a state that can no longer be stepped to.

        That is the initial one, or that of an instant that is over.
        """
        answered = self.answered
        return answered == NEVER or (self.inbox.last is None and stamp > answered)

    def _recent_answers(self) -> tuple[Answer, ...]:
        """Answers that a reader may have missed.

        They are the last one, and of an integrating object the one before. An integrating object is
        one answer ahead, so the others may still wait for the one before.
        """
        which = (BEFORE, ANSWER) if self.integrates else (ANSWER,)
        recent = map(self._answer, which)
        return tuple(answer for answer in recent if answer is not None)

    def _start(self, stamp: int) -> Answer:
        there = self.frame_of(stamp)
        there.numbers[TIME] = self._instant(stamp)
        self.part.start(there)
        note_answer(self._steps, stamp)
        return Answer(stamp, there)

    def _begin_anew(self) -> None:
        self.part = self._make()
        self._done[ANSWER] = self._done[BEFORE] = NEVER
        self._at_rest = True

    def begin_run(self) -> Answer:
        """Begin the next run at time zero.

        The answer is the initial state of an integrating object.
        """
        # The stamps of each run lie a little above those of the run before, so that its late
        # messages fit to no step.
        run = 0
        if self.inbox.last is not None:
            run = (self.inbox.run + stamps.RUN) % stamps.RUNS
        self._begin_anew()
        self.inbox.expect(run)
        return self._start(run)

    def step(self) -> Answer | None:
        """Take a step if its inputs are complete, else return None."""
        stamp = self.inbox.complete()
        if stamp is None:
            return None
        skipped = 0
        if self.integrates and (last := self.inbox.last) is not None:
            skipped = (stamp - last) // self.period - 1
        inputs = self.inbox.take(stamp)
        # Where steps may be skipped the inputs are held, so that time does not slip.
        for _ in range(skipped):
            self.step_with(stamp, inputs)
        return self.step_with(stamp, inputs)

    def step_with(self, stamp: int, here: Frame) -> Answer:
        """Take a step with the inputs in a frame.

        It is that of the inbox, except where a role integrates.
        """
        here.numbers[TIME] = self._instant(stamp)
        self._at_rest = False
        output = stamp + self._steps.lead
        there = self.frame_of(output)
        if self.integrates:
            there.numbers[TIME] = self._instant(output)
        self.part.step(here, there)
        note_answer(self._steps, output)
        return Answer(output, there)

    def _instant(self, stamp: int) -> float:
        """The time that a stamp means [s]."""
        return (stamp - stamp % self.period) / stamps.NANOSECONDS

    def inputs_of(self, stamp: int) -> Frame:
        """The frame of the inputs of a step."""
        return self._frames[row_of(self._steps, stamp)]

    def frame_of(self, stamp: int) -> Frame:
        """The frame of the answer for an instant."""
        return self._frames[row_of_answer(self._steps, stamp)]
