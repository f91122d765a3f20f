"""Frames to topics and back: publisher and subscription of a signal, and the one publisher that is admitted.

How it works: a topic of the graph belongs to one role. A message counts only if its publisher, by
the identity that the middleware gives to it, belongs to the node of that role in our namespace. The
look-up in the graph is slow, so that the identity which was admitted is remembered, and a refused
one is looked up again only after a while.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, Protocol, TypeAlias

from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile

from ev_core.lockstep.stepper import WRITERS
from ev_msgs_py.contract.frame import Frame
from ev_msgs_py.contract.roles import RECORDER
from ev_msgs_py.contract.topics import QUEUE_DEPTH, Topic
from ev_msgs_py.wire import format_of
from ev_nodes.node_loop.ordinary_steps import End
from ev_nodes.stepping.taking import taker_of

NAMELESS = "_UNKNOWN_"  # in the names that the middleware gives to nodes that it cannot name yet
QUALITY = QoSProfile(depth=QUEUE_DEPTH)  # reliable, volatile, keep last
HELD = (
    20 * QUEUE_DEPTH
)  # messages, until they are taken; those of strangers shall not displace the others
_HEARD = QoSProfile(depth=HELD)
_SOON, _LATER = (
    0.01,
    0.2,
)  # s of wall time between looks into the graph for a sender: not known yet, refused
_KEPT = 100  # senders that are remembered with the time of their next look-up
_LONG = 3.0  # s for the graph to name the node of a publisher
_NO_IDENTITY = {"data": b""}

SubscriptionHandle: TypeAlias = rclpy_implementation.Subscription  # wrapped by rclpy's Subscription
Refuse = Callable[[str, str], None]  # called with the node that is refused, and a line about it
Succeeded = Callable[[bytes], None]


class Judge(Protocol):
    """Decides which publishers are admitted."""

    def admits(self, info: Mapping[str, Any]) -> bool:
        """Return whether a message with this information, as rclpy gives it, is taken."""


class Speaker:
    """Admits the messages of one publisher: of the node with this name, in the namespace of the node that listens.

    Messages of every other publisher on the topic are counted in `refused`, and `refuse` is called
    when one is looked up. Two nodes with the allowed name cannot be distinguished: neither is
    admitted, unless one has been already. When the admitted publisher leaves the graph, another
    one, such as that of a restarted node, may take its place; `succeeded` is called with its
    identity then.
    """

    def __init__(
        self,
        node: Node,
        topic: str,
        name: str,
        refuse: Refuse,
        succeeded: Succeeded = lambda _: None,
    ) -> None:
        self._node, self._topic, self._refuse = node, node.resolve_topic_name(topic), refuse
        self._allowed = f"{node.get_namespace().rstrip('/')}/{name}"
        self.admitted: bytes | None = None
        self.succeeded = succeeded
        self._next_look: dict[
            bytes, float
        ] = {}  # when senders that are not admitted are looked up again
        self._nameless_since: float | None = None
        self.refused = 0

    def admits(self, info: Mapping[str, Any]) -> bool:
        """Return whether a message with this information, as rclpy gives it, is of the admitted publisher."""
        gid: bytes = (info.get("publisher_gid") or _NO_IDENTITY)["data"]
        if gid == self.admitted and gid:
            return True
        now = time.monotonic()
        if now >= self._next_look.get(gid, 0.0):
            if len(self._next_look) >= _KEPT:
                self._next_look.clear()
            self._next_look[gid] = now + _SOON
            if self._may_speak(gid):
                before, self.admitted = self.admitted, gid
                if before and gid and before != gid:  # an empty one is no other publisher
                    self.succeeded(gid)
            elif gid == self.admitted:
                self.admitted = None
        if gid == self.admitted:
            return True
        self.refused += 1
        return False

    def _may_speak(self, gid: bytes) -> bool:
        """Return whether a publisher is the only one of its name.

        As long as its node is not known, it is not. Where the sender of a message is not known (an
        empty `gid`: in executors of rclpy), it is believed as long as the topic has no other
        publisher.
        """
        there = {
            bytes(end.endpoint_gid): f"{end.node_namespace.rstrip('/')}/{end.node_name}"
            for end in self._node.get_publishers_info_by_topic(self._topic)
        }
        if gid:
            self._note_nameless(there.get(gid, NAMELESS))
        allowed = [other for other, name in there.items() if name == self._allowed]
        for other, name in there.items():
            if name != self._allowed and NAMELESS not in name and (not gid or other == gid):
                self._next_look[gid] = time.monotonic() + _LATER
                self._refuse(name, f"{name} is refused: {self._topic} is for {self._allowed} alone")
        if len(allowed) > 1 and self.admitted not in allowed:
            self._refuse(
                self._allowed,
                f"{self._allowed} is refused: {len(allowed)} nodes of this name on {self._topic}",
            )
        return allowed == [gid] if gid else len(there) == len(allowed) == 1

    def _note_nameless(self, name: str) -> None:
        """Report a sender on the topic if the graph has not been able to name its node for a long time."""
        if NAMELESS not in name:
            self._nameless_since = None
            return
        now = time.monotonic()
        if self._nameless_since is None:
            self._nameless_since = now
        elif now - self._nameless_since > _LONG:
            self._refuse(
                NAMELESS,
                f"a sender on {self._topic} is not admitted: the graph does not name its node",
            )


class SignalWriter:
    """Publishes one signal while it has subscribers."""

    def __init__(self, node: Node, topic: Topic) -> None:
        format_ = format_of(topic.signal)
        self.publisher: Publisher = node.create_publisher(
            format_.message_class, topic.name, QUALITY
        )
        self._format, self._pack = format_, format_.pack
        self._publish = self.publisher.handle.publish_raw
        self._readers = self.publisher.handle.get_subscription_count

    def write(self, stamp: int, here: Frame) -> None:
        """Publish the finite numbers of a signal in a frame.

        Without readers it costs nearly nothing.
        """
        if self._readers():
            self._publish(self._pack(stamp, here))

    @property
    def end(self) -> End:
        """The publisher, as compiled code takes it."""
        return End(self.publisher.handle.pointer, self._format)


class PolledGroup(MutuallyExclusiveCallbackGroup):
    """Subscriptions that executors leave alone while `spinning.spin` takes their messages with their senders."""

    polled = False

    def can_execute(self, entity: Any) -> bool:
        """Return whether an executor may take a message that has come."""
        return not self.polled and super().can_execute(entity)


class Reader:
    """Receives a topic from its admitted publisher, from any publisher without a `speaker`.

    Serialized messages go to `receive` if an executor takes them, else to the caller of `take`.
    """

    quality = _HEARD  # a subclass may receive by another one

    def __init__(
        self,
        node: Node,
        message_class: type,
        name: str,
        receive: Callable[[bytes], None],
        speaker: Judge | None,
    ) -> None:
        self.receive = receive
        self.speaker = speaker
        self._subscription = node.create_subscription(
            message_class,
            name,
            self._receive_from_executor,
            self.quality,
            callback_group=PolledGroup(),
            raw=True,
        )
        self.handle: SubscriptionHandle = self._subscription.handle
        self._take = taker_of(self.handle, message_class)
        self.close = partial(node.destroy_subscription, self._subscription)

    def take(self, patience: int = QUEUE_DEPTH) -> bytes | None:
        """The next message that is admitted, None if there is none, or none among so many of a stranger."""
        taken = self.take_with_time(patience)
        return None if taken is None else taken[0]

    def take_with_time(self, patience: int = QUEUE_DEPTH) -> tuple[bytes, int] | None:
        """Take the next message, with the wall time at which the middleware received it [ns]."""
        for _ in range(
            patience
        ):  # a sender that is faster than it is refused shall not keep the node from all else
            taken = self._take()
            if taken is None:
                return None
            message, info = taken
            if self.speaker is None or self.speaker.admits(info):
                return message, info[
                    "received_timestamp"
                ] or time.time_ns()  # 0: the middleware does not know
        return None

    def judge(self, message: bytes, info: Mapping[str, Any]) -> bool:
        """Receive a message if the publisher that the information names is admitted.

        False if it is not.
        """
        admitted = self.speaker is None or self.speaker.admits(info)
        if admitted:
            self.receive(message)
        return admitted

    def _receive_from_executor(self, message: bytes) -> None:
        """Receive a message without its sender, which not every executor passes on."""
        self.judge(message, {})


class SignalReader(Reader):
    """Receives a signal from the node of the role that writes it.

    `refuse` is called for others that publish it. `succeeded` of its speaker is called when that
    node has been started again.
    """

    speaker: Speaker

    def __init__(
        self, node: Node, topic: Topic, receive: Callable[[bytes], None], refuse: Refuse
    ) -> None:
        speaker = Speaker(node, topic.name, WRITERS.get(topic.signal, RECORDER), refuse)
        self._format = format_of(topic.signal)
        super().__init__(node, self._format.message_class, topic.name, receive, speaker)

    @property
    def end(self) -> End:
        """The subscription, as compiled code takes it."""
        return End(self.handle.pointer, self._format)
