"""Frames to topics and back: what publishes one signal, and what receives one."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile

from ev_msgs_py.contract.frame import Frame
from ev_msgs_py.contract.roles import RECORDER
from ev_msgs_py.contract.topics import QUEUE_DEPTH, Topic
from ev_msgs_py.lockstep.stepper import WRITERS
from ev_msgs_py.nodes.speaker import Judge, Refuse, Speaker, Succeeded
from ev_msgs_py.nodes.step_memory import End
from ev_msgs_py.wire.message_format import format_of

SubscriptionHandle = rclpy_implementation.Subscription  # what rclpy's Subscription wraps
QUALITY = QoSProfile(depth=QUEUE_DEPTH)  # reliable, volatile, keep last
HELD = 20 * QUEUE_DEPTH  # messages, until they are taken; those of strangers shall not displace the others
_HEARD = QoSProfile(depth=HELD)


class SignalWriter:
    """Publishes one signal while somebody hears it."""

    def __init__(self, node: Node, topic: Topic) -> None:
        format_ = format_of(topic.signal)
        self.publisher: Publisher = node.create_publisher(format_.message_class, topic.name, QUALITY)
        self._format, self._pack = format_, format_.pack
        self._publish = self.publisher.handle.publish_raw
        self._readers = self.publisher.handle.get_subscription_count

    def write(self, stamp: int, here: Frame) -> None:
        """Publish the signal in a frame, whose numbers are finite; without readers it costs nearly nothing."""
        if self._readers():
            self._publish(self._pack(stamp, here))

    @property
    def end(self) -> End:
        """The publisher, as compiled code takes it."""
        return End.of(self.publisher.handle.pointer, self._format)


class PolledGroup(MutuallyExclusiveCallbackGroup):
    """Subscriptions that executors leave alone while `spinning.spin` takes their messages, and who has sent them."""

    polled = False

    def can_execute(self, entity: Any) -> bool:
        """Whether an executor may take what has come."""
        return not self.polled and super().can_execute(entity)


class Reader:
    """Receives a topic from the one who may speak on it, from everybody without a `speaker`.

    Serialized messages go to `receive` if an executor takes them, else to whoever calls `take`.
    """

    def __init__(
        self,
        node: Node,
        message_class: type,
        name: str,
        receive: Callable[[bytes], None],
        speaker: Judge | None,
        quality: QoSProfile = _HEARD,
    ) -> None:
        self.receive, self.speaker = receive, speaker
        self._subscription = node.create_subscription(
            message_class, name, self._receive_from_executor, quality, callback_group=PolledGroup(), raw=True
        )
        self.handle: SubscriptionHandle = self._subscription.handle
        self._take = partial(self.handle.take_message, message_class, True)
        self.close = partial(node.destroy_subscription, self._subscription)

    def take(self, patience: int = QUEUE_DEPTH) -> bytes | None:
        """The next message that is admitted, None if there is none, or none among so many of a stranger."""
        taken = self.take_with_time(patience)
        return None if taken is None else taken[0]

    def take_with_time(self, patience: int = QUEUE_DEPTH) -> tuple[bytes, int] | None:
        """The same, with the wall time at which the middleware received it [ns]."""
        for _ in range(patience):  # who speaks faster than it is refused shall not keep the node from all else
            taken = self._take()
            if taken is None:
                return None
            message, info = taken
            if self.speaker is None or self.speaker.admits(info):
                return message, info["received_timestamp"] or time.time_ns()  # 0: the middleware does not tell
        return None

    def judge(self, message: bytes, info: Mapping[str, Any]) -> bool:
        """Receive a message if the publisher that the information names is admitted; whether it is."""
        admitted = self.speaker is None or self.speaker.admits(info)
        if admitted:
            self.receive(message)
        return admitted

    def _receive_from_executor(self, message: bytes) -> None:
        """Not every executor tells who has sent a message."""
        self.judge(message, {})


class SignalReader(Reader):
    """Receives a signal from the node of the role that writes it; `refuse` is told of others who speak of it.

    `succeeded` is told when that node has been started anew (`Speaker`).
    """

    def __init__(
        self,
        node: Node,
        topic: Topic,
        receive: Callable[[bytes], None],
        refuse: Refuse,
        quality: QoSProfile = _HEARD,
        succeeded: Succeeded = lambda _: None,
    ) -> None:
        speaker = Speaker(node, topic.name, WRITERS.get(topic.signal, RECORDER), refuse, succeeded)
        self._format = format_of(topic.signal)
        super().__init__(node, self._format.message_class, topic.name, receive, speaker, quality)

    @property
    def end(self) -> End:
        """The subscription, as compiled code takes it."""
        return End.of(self.handle.pointer, self._format)
