"""The recorder node: a bag of everything while the run lasts, signals.npz at its end."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from rclpy.node import Node
from rosgraph_msgs.msg import Clock

from ev_core.parameters.declaration import entries
from ev_core.parameters.values import build
from ev_msgs_py.contract.frame import Frame
from ev_msgs_py.contract.roles import MASTER, RECORDER, RECORDER_WRITES, ROLES
from ev_msgs_py.contract.topics import TOPICS, Topic
from ev_msgs_py.wire import MessageError, stamp_of
from ev_nodes.run_role import run_node
from ev_nodes.stepping import ros_parameters
from ev_nodes.stepping.reports import Reports, wait_until_heard
from ev_nodes.stepping.runner_line import PROGRESS, Waiting, Word
from ev_nodes.stepping.signal_io import OnePublisher, Reader, SignalReader, SignalWriter
from ev_nodes.stepping.spinning import Spinnable
from ev_stack.recording.run_recorder import RecorderParameters, RunRecorder
from ev_stack.scenarios.parameter_file import ParameterFile
from ev_stack.views.messages import CarViews, views_of_nodes

_Add = Callable[[list[bytes], list[int]], None]  # takes messages, and when they came [ns]
# s; several steps are taken in one go, which costs less than waking up for each message
POLL_PERIOD = 0.01
_PATIENCE = 2.0  # s
_LONG = 3.0  # s for the first message of a topic
_NOTHING = Frame()  # the progress is nothing but its stamp


class RecorderInput:
    """Gives serialized messages to a recorder.

    With `beside` also those that are no signals of the contract.

    `reports` gets a line on nodes that publish where they may not, and on messages that cannot be
    kept.
    """

    def __init__(
        self,
        node: Node,
        topics: Sequence[Topic],
        recorder: RunRecorder,
        beside: bool,
        reports: Reports,
    ) -> None:
        self._recorder, self._reports = recorder, reports
        self._clock_stamp = -1
        # of /clock, for a run before its first state is taken
        self._early: list[tuple[int, bytes, int]] = []
        self._next_poll = 0.0
        self.refused = 0
        # The master's first: no node answers an instant before the master sends it, so nothing
        # seems to be ahead of it.
        masters_first = sorted(
            enumerate(topics), key=lambda place: place[1].signal not in ROLES[MASTER].writes
        )
        self._readers: list[tuple[Reader, _Add]] = []
        for index, topic in masters_first:
            add = partial(recorder.add, index, refuse=partial(self._refuse, topic))
            self._readers.append((SignalReader(node, topic, _one(add), reports), add))
        if beside:
            judge = OnePublisher(node, "/clock", MASTER, reports)
            self._readers.append(
                (Reader(node, Clock, "/clock", _one(self._add_clock), judge), self._add_clock)
            )
            everybody = Reader(
                node, DiagnosticArray, "/diagnostics", _one(self._add_diagnostics), None
            )
            self._readers.append((everybody, self._add_diagnostics))

    def _refuse(self, topic: Topic, error: MessageError) -> None:
        self.refused += 1
        self._reports.note(topic.name, f"{topic.name} ignored: {error}")

    def _add_clock(self, messages: list[bytes], came: list[int]) -> None:
        for message, time_of_arrival in zip(messages, came, strict=True):
            stamp = stamp_of(message)
            # the master repeats the stamp where it repeats the state
            if stamp != self._clock_stamp:
                self._clock_stamp = stamp
                self._early.append((stamp, message, time_of_arrival))
        kind = "rosgraph_msgs/msg/Clock"
        self._early = [
            each for each in self._early if not self._recorder.add_beside("/clock", kind, *each)
        ]

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


class RecorderNode(Spinnable, Node):
    """Records all topics of the contract and reports to the master of time how far it is."""

    _recorder: RunRecorder | None = None  # until there is something to write

    def __init__(self, **node_arguments: Any) -> None:
        super().__init__(
            "recorder", automatically_declare_parameters_from_overrides=True, **node_arguments
        )
        p = build(RecorderParameters, ros_parameters.overrides(self))
        ros_parameters.declare(self, entries(p))
        topics = [topic for topic in TOPICS.values() if topic.name in p.topics]
        names = [self.resolve_topic_name(topic.name) for topic in topics]
        self._recorder = RunRecorder(p, topics, names, self._views(p))
        try:
            self._begin(p, topics)
        # no caller can close this node: its bag would be written on after the last word
        except BaseException:
            self._recorder.close()
            raise

    def _views(self, p: RecorderParameters) -> CarViews | None:
        if not (p.bag and p.parameter_file):
            return None
        file, space = ParameterFile(Path(p.parameter_file)), self.get_namespace()
        named = {
            role: file.values_for(f"{space.rstrip('/')}/{role}") for role in (*ROLES, RECORDER)
        }
        # Nodes that the file does not name have no part in the run.
        return views_of_nodes(space, {role: values for role, values in named.items() if values})

    def _begin(self, p: RecorderParameters, topics: list[Topic]) -> None:
        self._reports = Reports(self, RECORDER)
        self._waiting = Waiting(self._reports.runner)
        self._input = RecorderInput(self, topics, self._recorder, p.bag, self._reports)
        self._reported = -1
        self._asked_since = 0.0  # wall time at which the master waited for us first
        self._progress = SignalWriter(self, TOPICS[RECORDER_WRITES])
        self.every(POLL_PERIOD, self.idle)

    def poll(self) -> bool:
        """Take every message that has arrived, now and then.

        It returns False, so that the node rests in between.
        """
        self._input.take_all()
        return False

    def wake_up_within(self) -> float:
        """Seconds of rest between two polls."""
        return POLL_PERIOD

    def idle(self) -> None:
        """Tell how far the recording is, and end it when it is complete."""
        if self.done:
            return
        recorder = self._recorder
        recorder.took_all()
        held = recorder.held_stamp
        self._waiting.look(held, (MASTER,))
        # Also when the master asks again: our last report may have been lost.
        if held != self._reported or recorder.asked:
            if silent := recorder.silent:
                self._name(silent)
            else:
                self._asked_since = 0.0
                self._progress.write(held, _NOTHING)
                self._reports.runner.tell(Word(PROGRESS, values={"stamp": recorder.held}))
            self._reported, recorder.asked = held, False
        if recorder.loss:
            raise RuntimeError(f"the recording has a gap: {recorder.loss}")
        # Only behind the report: the master ends when it knows that all is held.
        if recorder.is_complete:
            self._wait_for_the_master()
            self.close()
            self.done = True
        recorder.flush()

    def _name(self, silent: list[str]) -> None:
        """Name the topics that the others wait for, once the master has asked for a while."""
        self._asked_since = self._asked_since or time.monotonic()
        if time.monotonic() > self._asked_since + _LONG:
            self._reports.note("silent", f"nothing has come on {', '.join(silent)}")

    def _wait_for_the_master(self) -> None:
        """The last message is lost if the process ends before it arrives.

        Other subscribers need not receive it.
        """
        publisher, master = self._progress.publisher, (MASTER, self.get_namespace())

        def is_there() -> bool:
            ends = self.get_subscriptions_info_by_topic(publisher.topic_name)
            return master in {(end.node_name, end.node_namespace) for end in ends}

        wait_until_heard(publisher, time.monotonic() + _PATIENCE, is_there)

    def close(self) -> None:
        """Leave nothing unwritten behind."""
        if self._recorder is not None:
            self._recorder.close()
        self._reports.runner.close()


def main() -> None:
    """ros2 run ev_stack recorder"""
    run_node("recorder", RecorderNode)
