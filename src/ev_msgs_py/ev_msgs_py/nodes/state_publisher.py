"""The state of an instant on its topics, and the clock."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable

from rclpy.node import Node
from rosgraph_msgs.msg import Clock

from ev_msgs_py.lockstep.stepper import Answer
from ev_msgs_py.nodes.last_words import wait_until_heard
from ev_msgs_py.nodes.signal_io import QUALITY, SignalWriter
from ev_msgs_py.nodes.step_memory import End
from ev_msgs_py.wire.message_format import stamp_alone

_PATIENCE = 20.0  # s of wall time for the last states to arrive, on a machine with much other work


class StatePublisher:
    """Publishes what the master says, and knows for how long it has said nothing."""

    def __init__(self, node: Node, writers: Iterable[SignalWriter]) -> None:
        self._writers = list(writers)
        self._clock = node.create_publisher(Clock, "/clock", QUALITY).handle
        self.spoke = 0.0

    def publish(self, answer: Answer) -> None:
        """Publish the signals of an answer, and then its stamp as /clock."""
        for writer in self._writers:
            writer.write(answer.stamp, answer.frame)
        if self._clock.get_subscription_count():
            self._clock.publish_raw(stamp_alone(answer.stamp))
        self.spoke = time.monotonic()

    def repeat(self, answer: Answer | None) -> None:
        """Publish once more, and first what most nodes hear: their step goes on while the rest is being published."""
        self._writers.sort(key=lambda writer: -writer.publisher.get_subscription_count())
        if answer is not None:
            self.publish(answer)

    def wait_until_heard(self, is_wanted: Callable[[], bool]) -> None:
        """Wait until the last states have arrived, for as long as they are wanted; what hangs is given up."""
        given_up = time.monotonic() + _PATIENCE
        for writer in self._writers:
            wait_until_heard(writer.publisher, given_up, is_wanted)

    def ends(self) -> list[End]:
        """All publishers, in the order in which they speak."""
        return [*(writer.end for writer in self._writers), End(self._clock.pointer, stamp_alone(0))]

    @property
    def silent_for(self) -> float:
        """Wall time since the last message [s]."""
        return time.monotonic() - self.spoke
