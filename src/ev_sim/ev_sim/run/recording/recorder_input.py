"""What the recorder hears: the topics of the contract, and for the bag alone /clock and /diagnostics."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

from diagnostic_msgs.msg import DiagnosticArray
from rclpy.node import Node
from rosgraph_msgs.msg import Clock

from ev_msgs_py.contract.roles import MASTER, ROLES
from ev_msgs_py.contract.topics import Topic
from ev_msgs_py.nodes.signal_io import QUALITY
from ev_msgs_py.wire.layout import MessageError
from ev_msgs_py.wire.message_classes import message_class
from ev_msgs_py.wire.message_format import stamp_of
from ev_sim.run.recording.run_recorder import RunRecorder

POLL_PERIOD = 0.01  # s; several steps are taken in one go, which costs less than waking up for each message


class RecorderInput:
    """Gives serialized messages to a recorder; with `beside` also those that are no signals of the contract."""

    def __init__(self, node: Node, topics: Sequence[Topic], recorder: RunRecorder, beside: bool) -> None:
        self._node, self._recorder = node, recorder
        self._clock_stamp = -1
        self._next_poll = 0.0
        # The master's first: nobody speaks of an instant before the master does, so nothing seems to be ahead of it.
        masters_first = sorted(enumerate(topics), key=lambda place: place[1].signal not in ROLES[MASTER].writes)
        self._subscriptions = [
            self._subscribe(message_class(topic.message_type), topic.name, self._adder(index, topic))
            for index, topic in masters_first
        ]
        if beside:
            self._subscriptions.append(self._subscribe(Clock, "/clock", self._on_clock))
            self._subscriptions.append(self._subscribe(DiagnosticArray, "/diagnostics", self._on_diagnostics))

    def _subscribe(self, kind: type, name: str, receive: Callable[[bytes], None]):
        return self._node.create_subscription(kind, name, receive, QUALITY, raw=True)

    def _adder(self, index: int, topic: Topic) -> Callable[[bytes], None]:
        def receive(message: bytes) -> None:
            try:
                self._recorder.add(index, message)
            except MessageError as error:
                self._node.get_logger().warning(f"{topic.name} ignored: {error}")

        return receive

    def _on_clock(self, message: bytes) -> None:
        stamp = stamp_of(message)
        if stamp != self._clock_stamp:  # the master repeats the stamp where it repeats the state
            self._clock_stamp = stamp
            self._recorder.add_beside("/clock", "rosgraph_msgs/msg/Clock", message, stamp)

    def _on_diagnostics(self, message: bytes) -> None:
        stamp = max(self._clock_stamp, 0)
        self._recorder.add_beside("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray", message, stamp)

    def take_all(self) -> None:
        """Take every message that has arrived, unless the last look was a moment ago."""
        if time.monotonic() < self._next_poll:
            return
        self._next_poll = time.monotonic() + POLL_PERIOD
        for subscription in self._subscriptions:
            handle = subscription.handle
            while (taken := handle.take_message(subscription.msg_type, True)) is not None:
                subscription.callback(taken[0])
