"""Frames to topics and back: what publishes one signal, and what receives one."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile

from ev_msgs_py.contract.frame import Frame
from ev_msgs_py.contract.topics import QUEUE_DEPTH, Topic
from ev_msgs_py.wire.message_format import format_of

SubscriptionHandle = rclpy_implementation.Subscription  # what rclpy's Subscription wraps
QUALITY = QoSProfile(depth=QUEUE_DEPTH)  # reliable, volatile, keep last


class SignalWriter:
    """Publishes one signal while somebody hears it."""

    def __init__(self, node: Node, topic: Topic) -> None:
        format_ = format_of(topic.signal)
        self.publisher: Publisher = node.create_publisher(format_.message_class, topic.name, QUALITY)
        self._pack = format_.pack
        self._publish = self.publisher.handle.publish_raw
        self._readers = self.publisher.handle.get_subscription_count

    def write(self, stamp: int, here: Frame) -> None:
        """Publish the signal in a frame, whose numbers are finite; without readers it costs nearly nothing."""
        if self._readers():
            self._publish(self._pack(stamp, here))


class SignalReader:
    """Receives one signal: gives each serialized message to `receive`, from an executor or when somebody takes it."""

    def __init__(self, node: Node, topic: Topic, receive: Callable[[bytes], None]) -> None:
        message_class = format_of(topic.signal).message_class
        self.receive = receive
        self._subscription = node.create_subscription(message_class, topic.name, receive, QUALITY, raw=True)
        self.handle: SubscriptionHandle = self._subscription.handle
        # Gives a message and what is known of it, or None.
        self.take = partial(self.handle.take_message, message_class, True)
