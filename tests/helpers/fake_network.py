"""A network of steppers in one process.

Topics are queues that lose, repeat and delay, as a seed says.

Messages of one topic reach a reader in order; between topics and readers there is no order at all.
"""

from __future__ import annotations

import random
from collections import defaultdict, deque
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from ev_core.lockstep.configuration import Configuration
from ev_core.lockstep.inbox import Arrival
from ev_core.lockstep.parts import part_of
from ev_core.lockstep.stepper import Answer, Stepper
from ev_msgs_py.contract.frame import PLACES, Frame
from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.contract.topics import TOPICS


class WatchedStepper(Stepper):
    """Remembers the stamps of its steps."""

    def __init__(self, configuration: Configuration, may_skip: bool = False) -> None:
        self.stepped: list[int] = []
        self.writes = configuration.method.writes
        self.configuration = configuration  # what a run begins with
        super().__init__(
            configuration.method,
            lambda: part_of(self.configuration, compiled=False),
            configuration.period,
            may_skip,
        )

    def change(self, configuration: Configuration) -> None:
        """Change the parameters of a node.

        They hold from the next run on, or from the first one if the node was silent.
        """
        self.configuration = configuration
        if self.answer is None:
            self.part = part_of(configuration, compiled=False)

    def step_with(self, stamp: int, here: Frame) -> Answer:
        self.stepped.append(stamp)
        return super().step_with(stamp, here)


@dataclass(frozen=True)
class Faults:
    """Probabilities, per message and reader, and of a retry while messages are still under way."""

    loss: float = 0.0
    repetition: float = 0.0
    early_retry: float = 0.0


class Stuck(AssertionError):
    """The run does not go on, however often the master repeats itself."""


class FakeNetwork:
    """A graph with faulty queues between its nodes; its master is the plant."""

    def __init__(
        self,
        configurations: Mapping[str, Configuration],
        steps: int,
        seed: int = 0,
        faults: Faults | None = None,
    ) -> None:
        self.configurations = configurations
        self.faults = faults or Faults()
        self._random = random.Random(seed)
        self._end = steps * configurations[MASTER].period
        self._queues: dict[tuple[str, type], deque] = defaultdict(deque)
        self.steppers = {
            role: WatchedStepper(configuration) for role, configuration in configurations.items()
        }
        self.deaf: set[tuple[str, type]] = set()  # readers and topics that are not connected yet
        self.sent: dict[type, dict[int, Any]] = {}
        # whether a node may send other numbers for an instant, as one does that has lost its memory
        self.forgives = False
        self.frozen = False  # whether the master stays where it is
        self.messages = 0
        self.silences = 0
        self.arrivals: list[Arrival] = []

    @property
    def master(self) -> WatchedStepper:
        return self.steppers[MASTER]

    @property
    def now(self) -> int:
        """The instant of the master."""
        return self.master.answer.stamp - self.master.inbox.run

    @property
    def at_end(self) -> bool:
        return self.now >= self._end and self.master.inbox.complete() is not None

    def begin(self) -> None:
        """The master begins a run; what was sent in the one before is forgotten."""
        self.sent = defaultdict(dict)
        self._publish(MASTER, self.master.begin_run())

    def restart(self, role: str) -> None:
        """The node dies, with what was on its way to it, and a new one takes its place."""
        self.steppers[role] = WatchedStepper(self.configurations[role])
        for place in [place for place in self._queues if place[0] == role]:
            del self._queues[place]

    def turn(self) -> None:
        """One message arrives somewhere, or the master repeats itself because none is under way."""
        waiting = [place for place, queue in self._queues.items() if queue]
        self.silences += not waiting
        if not waiting or self._random.random() < self.faults.early_retry:
            self.retry()
            return
        role, kind = self._random.choice(waiting)
        self._receive(role, kind, *self._queues[role, kind].popleft())

    def retry(self) -> None:
        """The master publishes its state once more."""
        self._publish(MASTER, self.master.answer)

    def run(self, patience: int = 200) -> None:
        """Drive the run to its end.

        Stuck if the master repeats one state so often in vain, or nothing else happens.
        """
        stamp, silences, turns = self.now, 0, 0
        while not self.at_end:
            before = self.silences
            self.turn()
            silences += self.silences - before
            turns += 1
            if self.now != stamp:
                stamp, silences, turns = self.now, 0, 0
            if silences > patience or turns > 100 * patience:
                waits = {
                    r: [k.__name__ for k in s.inbox.missing()] for r, s in self.steppers.items()
                }
                raise Stuck(f"at step {stamp // self.master.period}, waiting: {waits}")

    def drain(self, most: int = 10_000) -> int:
        """Deliver what is under way and what it leads to.

        The number of messages sent, Stuck if it does not end.
        """
        before = self.messages
        while waiting := [place for place, queue in self._queues.items() if queue]:
            role, kind = self._random.choice(waiting)
            self._receive(role, kind, *self._queues[role, kind].popleft())
            if self.messages - before > most:
                raise Stuck("messages lead to messages without an end")
        return self.messages - before

    def _receive(self, role: str, kind: type, stamp: int, numbers: list[float]) -> None:
        stepper = self.steppers[role]
        arrival = stepper.inbox.offer(kind, stamp, numbers)
        self.arrivals.append(arrival)
        if role != MASTER:
            for answer in stepper.answers_to(kind, stamp, arrival):
                self._publish(role, answer)
        elif arrival is Arrival.NEW:
            while not self.frozen and self.now < self._end and stepper.inbox.complete() is not None:
                self._publish(role, stepper.step())

    def _publish(self, role: str, answer: Answer) -> None:
        """Send an answer to its readers.

        A node may contradict a message of a run before: a late stamp zero restarts it with its new
        parameters.
        """
        for kind in self.steppers[role].writes:
            numbers = answer.frame.numbers[PLACES[kind]].tolist()
            if answer.stamp % self.master.period == self.master.inbox.run:
                before = self.sent[kind].setdefault(answer.stamp, numbers)
                assert repr(before) == repr(numbers) or self.forgives, (
                    f"{role} changed its mind about {answer.stamp}"
                )
            self.messages += 1
            for reader, stepper in self.steppers.items():
                if kind in stepper.reads and (reader, kind) not in self.deaf:
                    self._send(reader, kind, answer.stamp, numbers)

    def _send(self, reader: str, kind: type, stamp: int, numbers: list[float]) -> None:
        if self._random.random() >= self.faults.loss:
            copies = 2 if self._random.random() < self.faults.repetition else 1
            self._queues[reader, kind].extend([(stamp, numbers)] * copies)

    def instants(self) -> list[int]:
        """The stamps of the run."""
        run = self.master.inbox.run
        return list(range(run, run + self._end + 1, self.master.period))

    def signals(self) -> dict[str, list[str]]:
        """Every number that was sent up to the end, by channel, as hexadecimal text.

        Equal text is equal bits.
        """
        channels = {}
        for kind, by_stamp in self.sent.items():
            rows = [by_stamp[stamp] for stamp in self.instants()]
            for channel, column in zip(TOPICS[kind].channels, zip(*rows, strict=True), strict=True):
                channels[channel] = [float.hex(number) for number in column]
        return channels
