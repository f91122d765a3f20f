"""Frames to topics and back: publisher and subscription of a signal, and the one publisher that is admitted.

How it works: a topic of the graph belongs to one role. A message counts only if its publisher, by
the identity that the middleware gives to it, belongs to the node of that role in our namespace. The
look-up in the graph is slow, so the identity that was admitted is remembered, and one that was
refused is looked up again only after a while.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial
from typing import Any, Protocol, TypeAlias

from rclpy.callback_groups import CallbackGroup
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile

from ev_core.lockstep.stepper import WRITERS
from ev_msgs_py.contract.frame import Frame
from ev_msgs_py.contract.roles import RECORDER
from ev_msgs_py.contract.topics import QUEUE_DEPTH, Topic
from ev_msgs_py.wire import format_of
from ev_nodes.rcl.taking import End, taker_of

NAMELESS = "_UNKNOWN_"  # in the names that the middleware gives to nodes that it cannot name yet
QUALITY = QoSProfile(depth=QUEUE_DEPTH)  # reliable, volatile, keep last
# Messages that are held until they are taken; foreign ones shall not displace the others.
HELD = 20 * QUEUE_DEPTH
_RECEIVED = QoSProfile(depth=HELD)
_SOON = 0.01  # s of wall time until a publisher of an unknown node is looked up again
_LATER = 0.2  # the same of one that was refused
_LONG = 3.0  # s for the graph to name the node of a publisher
_MOST = 100  # refused publishers that are remembered

SubscriptionHandle: TypeAlias = rclpy_implementation.Subscription  # wrapped by rclpy's Subscription


def full_name(end: Any) -> str:
    """Full name of the node of a publisher or subscription."""
    return f"{end.node_namespace.rstrip('/')}/{end.node_name}"


class Refusals(Protocol):
    """Takes reports on publishers that are not admitted, as `Reports` does."""

    def note(self, what: str, text: str) -> None:
        """Report, once of each `what`, a thing that changes no number."""

    def warn_once(self, what: str, text: str) -> None:
        """Report, once of each `what`, why the run may not be reproducible."""


class Judge(Protocol):
    """Decides which publishers are admitted."""

    def admits(self, gid: bytes) -> bool:
        """Return whether the messages of the publisher with this identity are taken."""


class OnePublisher:
    """Admits the messages of one publisher: of the node with this name, in the namespace of the node that reads.

    Messages of every other publisher on the topic are counted in `refused`, and its node is
    reported. Two nodes with the expected name cannot be distinguished: neither is admitted, unless
    one has been already, and the run may not be reproducible. When the admitted publisher leaves
    the graph, another one, such as that of a restarted node, may take its place; `succeeded` is
    called with its identity then.
    """

    def __init__(self, node: Node, topic: str, name: str, refusals: Refusals) -> None:
        self._node = node
        self._topic = node.resolve_topic_name(topic)
        self._expected = f"{node.get_namespace().rstrip('/')}/{name}"
        self._refusals = refusals
        self._next_look: dict[bytes, float] = {}
        self._nameless_since: float | None = None
        self.admitted: bytes | None = None
        self.succeeded: Callable[[bytes], None] = lambda _: None
        self.refused = 0

    def admits(self, gid: bytes) -> bool:
        """Return whether a message is of the admitted publisher.

        The identity is empty if an executor of rclpy has taken the message.
        """
        if gid and gid == self.admitted:
            return True
        now = time.monotonic()
        if now >= self._next_look.get(gid, 0.0):
            self._look_up(gid, now)
        if gid == self.admitted:
            return True
        self.refused += 1
        return False

    def _look_up(self, gid: bytes, now: float) -> None:
        """Admit a publisher if it is the only one of its name, else report it."""
        if len(self._next_look) >= _MOST:
            self._next_look.clear()
        self._next_look[gid] = now + _SOON
        ends = self._node.get_publishers_info_by_topic(self._topic)
        names = {bytes(end.endpoint_gid): full_name(end) for end in ends}
        ours = [each for each, name in names.items() if name == self._expected]
        # Without an identity a message may be of any publisher of the topic.
        alone = ours == [gid] if gid else len(names) == len(ours) == 1
        if alone:
            before, self.admitted = self.admitted, gid
            self._nameless_since = None
            if before and gid and before != gid:
                self.succeeded(gid)
            return
        if self.admitted == gid:
            self.admitted = None
        if len(ours) > 1:  # numbers of the other one may have counted
            self._refusals.warn_once(
                self._expected,
                f"{len(ours)} nodes are called {self._expected}, expected one: "
                "the run may not be reproducible",
            )
        senders = [names.get(gid, NAMELESS)] if gid else names.values()
        for name in senders:
            if name != self._expected:
                self._report_foreign(gid, name, now)

    def _report_foreign(self, gid: bytes, name: str, now: float) -> None:
        """Report another node on the topic, or one that the graph has not named for long."""
        if NAMELESS not in name:
            self._nameless_since = None
            self._next_look[gid] = now + _LATER
            self._refusals.note(
                name, f"{name} is refused: {self._topic} is for {self._expected} alone"
            )
        elif self._nameless_since is None:
            self._nameless_since = now
        elif now - self._nameless_since > _LONG:
            self._refusals.note(
                NAMELESS,
                f"a publisher of {self._topic} is refused: the graph does not name its node",
            )


class SignalWriter:
    """Publishes one signal while it has subscribers."""

    def __init__(self, node: Node, topic: Topic) -> None:
        format_ = format_of(topic.signal)
        self.publisher: Publisher = node.create_publisher(
            format_.message_class, topic.name, QUALITY
        )
        self._format = format_
        self._pack = format_.pack
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


class PolledGroup(CallbackGroup):
    """Subscriptions that executors leave alone while `spinning.spin` takes their messages.

    An executor with several threads runs them one at a time, and none beside a callback of the
    group `beside`: a step and a change of parameters share the part of the node.
    """

    polled = False

    def __init__(self, beside: CallbackGroup) -> None:
        super().__init__()
        self._beside = beside

    def add_entity(self, entity: Any) -> None:
        """Add a subscription to both groups."""
        super().add_entity(entity)
        self._beside.add_entity(entity)

    def can_execute(self, entity: Any) -> bool:
        """Return whether an executor may take a message that has come."""
        return not self.polled and self._beside.can_execute(entity)

    def beginning_execution(self, entity: Any) -> bool:
        """Return whether an executor may call back now."""
        return self._beside.beginning_execution(entity)

    def ending_execution(self, entity: Any) -> None:
        """Let the next callback begin."""
        self._beside.ending_execution(entity)


class Reader:
    """Receives a topic from its admitted publisher, from any publisher without a `judge`.

    Serialized messages go to `receive` if an executor takes them, else to the caller of `take`.
    """

    quality = _RECEIVED  # a subclass may receive by another one

    def __init__(
        self,
        node: Node,
        message_class: type,
        name: str,
        receive: Callable[[bytes], None],
        judge: Judge | None,
    ) -> None:
        self.receive = receive
        self.judge = judge
        self._subscription = node.create_subscription(
            message_class,
            name,
            self._receive_from_executor,
            self.quality,
            callback_group=PolledGroup(node.default_callback_group),
            raw=True,
        )
        self.handle: SubscriptionHandle = self._subscription.handle
        self._take = taker_of(self.handle, message_class)
        self.close = partial(node.destroy_subscription, self._subscription)

    def take(self, patience: int = QUEUE_DEPTH) -> bytes | None:
        """The next message that is admitted, None if there is none, or none among so many foreign ones."""
        taken = self.take_with_time(patience)
        return None if taken is None else taken[0]

    def take_with_time(self, patience: int = QUEUE_DEPTH) -> tuple[bytes, int] | None:
        """Take the next message, with the wall time at which the middleware received it [ns]."""
        # A publisher that is faster than it is refused shall not keep the node from all else.
        for _ in range(patience):
            taken = self._take()
            if taken is None:
                return None
            if self.judge is None or self.judge.admits(taken.gid):
                return taken.message, taken.received or time.time_ns()
        return None

    def receive_from(self, gid: bytes, message: bytes) -> None:
        """Receive a message if the publisher with this identity is admitted."""
        if self.judge is None or self.judge.admits(gid):
            self.receive(message)

    def _receive_from_executor(self, message: bytes) -> None:
        """Receive a message without its publisher, which not every executor passes on."""
        self.receive_from(b"", message)


class SignalReader(Reader):
    """Receives a signal from the node of the role that writes it.

    `refusals` is given other publishers of it.
    """

    judge: OnePublisher

    def __init__(
        self, node: Node, topic: Topic, receive: Callable[[bytes], None], refusals: Refusals
    ) -> None:
        writer = WRITERS.get(topic.signal, RECORDER)
        judge = OnePublisher(node, topic.name, writer, refusals)
        self._format = format_of(topic.signal)
        super().__init__(node, self._format.message_class, topic.name, receive, judge)

    @property
    def end(self) -> End:
        """The subscription, as compiled code takes it."""
        return End(self.handle.pointer, self._format)
