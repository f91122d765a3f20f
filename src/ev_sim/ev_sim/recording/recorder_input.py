"""What the recorder takes: the topics of the contract, and for the bag alone /clock and /diagnostics."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from functools import partial

from diagnostic_msgs.msg import DiagnosticArray
from rclpy.node import Node
from rosgraph_msgs.msg import Clock

from ev_core.nodes.reports import Reports
from ev_core.nodes.signal_io import Reader, SignalReader, Speaker
from ev_msgs_py.contract.roles import MASTER, ROLES
from ev_msgs_py.contract.topics import Topic
from ev_msgs_py.wire.layout import MessageError
from ev_msgs_py.wire.message_format import stamp_of
from ev_sim.recording.run_recorder import RunRecorder

_Add = Callable[[list[bytes], list[int]], None]  # takes messages, and when they came [ns]
POLL_PERIOD = 0.01  # s; several steps are taken in one go, which costs less than waking up for each message


class RecorderInput:
    """Gives serialized messages to a recorder; with `beside` also those that are no signals of the contract.

    `reports` gets a line on nodes that publish where they may not, and on messages that cannot be kept.
    """

    def __init__(
        self, node: Node, topics: Sequence[Topic], recorder: RunRecorder, beside: bool, reports: Reports
    ) -> None:
        self._node, self._recorder, self._reports = node, recorder, reports
        self._clock_stamp = -1
        self._early: list[tuple[int, bytes, int]] = []  # of /clock, for a run whose first state has yet to be taken
        self._next_poll = 0.0
        self.refused = 0
        # The master's first: nobody answers an instant before the master sends it, so nothing seems to be ahead of it.
        masters_first = sorted(enumerate(topics), key=lambda place: place[1].signal not in ROLES[MASTER].writes)
        self._readers: list[tuple[Reader, _Add]] = []
        for index, topic in masters_first:
            add = partial(recorder.add, index, refuse=partial(self._refuse, topic))
            self._readers.append((SignalReader(node, topic, _one(add), reports.note), add))
        if beside:
            speaker = Speaker(node, "/clock", MASTER, reports.note)
            self._readers.append((Reader(node, Clock, "/clock", _one(self._add_clock), speaker), self._add_clock))
            everybody = Reader(node, DiagnosticArray, "/diagnostics", _one(self._add_diagnostics), None)
            self._readers.append((everybody, self._add_diagnostics))

    def _refuse(self, topic: Topic, error: MessageError) -> None:
        self.refused += 1
        self._reports.note(topic.name, f"{topic.name} ignored: {error}")

    def _add_clock(self, messages: list[bytes], came: list[int]) -> None:
        for message, time_of_arrival in zip(messages, came, strict=True):
            stamp = stamp_of(message)
            if stamp != self._clock_stamp:  # the master repeats the stamp where it repeats the state
                self._clock_stamp = stamp
                self._early.append((stamp, message, time_of_arrival))
        kind = "rosgraph_msgs/msg/Clock"
        self._early = [each for each in self._early if not self._recorder.add_beside("/clock", kind, *each)]

    def _add_diagnostics(self, messages: list[bytes], came: list[int]) -> None:
        kind, stamp = "diagnostic_msgs/msg/DiagnosticArray", self._recorder.held_stamp
        for message, time_of_arrival in zip(messages, came, strict=True):
            self._recorder.add_beside("/diagnostics", kind, stamp, message, time_of_arrival)

    def take_all(self) -> None:
        """Take every message that has arrived, unless the last look was a moment ago."""
        if time.monotonic() < self._next_poll:
            return
        self._next_poll = time.monotonic() + POLL_PERIOD
        for reader, add in self._readers:
            messages, came = [], []
            while (taken := reader.take_with_time()) is not None:
                messages.append(taken[0])
                came.append(taken[1])
            if messages:
                add(messages, came)


def _one(add: _Add) -> Callable[[bytes], None]:
    """Executors of rclpy's own do not give the time at which a message came."""
    return lambda message: add([message], [time.time_ns()])
