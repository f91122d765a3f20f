"""Who may speak on a topic: one publisher, that of the node whose task it is."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from typing import Any, Protocol

from rclpy.node import Node

_SOON, _LATER = 0.01, 0.2  # s of wall time between looks into the graph for a sender: not known yet, refused
_KEPT = 100  # senders of whom it is known when they were looked up
NAMELESS = "_UNKNOWN_"  # in the names that the middleware gives to what it knows no name of
_LONG = 3.0  # s for the graph to tell whose publisher has been heard

Refuse = Callable[[str, str], None]  # is told the node that is refused, and a line about it
Succeeded = Callable[[bytes], None]


class Judge(Protocol):
    """Knows who may speak."""

    def admits(self, info: Mapping[str, Any]) -> bool:
        """Whether a message with this information, as rclpy gives it, is heard."""


class Speaker:
    """Admits the messages of one publisher: of the node with this name, in the namespace of the node that listens.

    Whoever else publishes on the topic is counted in `refused`, and `refuse` is told of it when it is looked up. Two
    nodes with the name that is allowed cannot be told apart: neither is admitted, unless one has been already. When the
    publisher that was admitted leaves the graph, another one, such as that of a restarted node, may take its place;
    `succeeded` is told its identity then.
    """

    def __init__(
        self, node: Node, topic: str, name: str, refuse: Refuse, succeeded: Succeeded = lambda _: None
    ) -> None:
        self._node, self._topic, self._refuse = node, node.resolve_topic_name(topic), refuse
        self._allowed = f"{node.get_namespace().rstrip('/')}/{name}"
        self.admitted: bytes | None = None
        self._succeeded = succeeded
        self._next_look: dict[bytes, float] = {}  # when senders that are not admitted are looked up again
        self._nameless_since: float | None = None
        self.refused = 0

    def admits(self, info: Mapping[str, Any]) -> bool:
        """Whether a message with this information, as rclpy gives it, comes from the one who may speak."""
        gid: bytes = (info.get("publisher_gid") or _UNTOLD)["data"]
        if gid == self.admitted and gid:
            return True
        now = time.monotonic()
        if now >= self._next_look.get(gid, 0.0):
            if len(self._next_look) >= _KEPT:
                self._next_look.clear()
            self._next_look[gid] = now + _SOON
            if self._may_speak(gid):
                before, self.admitted = self.admitted, gid
                if before not in (None, gid):
                    self._succeeded(gid)
            elif gid == self.admitted:
                self.admitted = None
        if gid == self.admitted:
            return True
        self.refused += 1
        return False

    def _may_speak(self, gid: bytes) -> bool:
        """Whether a publisher is the only one of its name; whose node is not known yet, may speak later.

        Where nobody tells who has sent a message (an empty `gid`: before ROS 2 Kilted, and executors of rclpy's), it is
        believed as long as nobody else could have.
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
                self._allowed, f"{self._allowed} is refused: {len(allowed)} nodes of this name on {self._topic}"
            )
        return allowed == [gid] if gid else len(there) == len(allowed) == 1

    def _note_nameless(self, name: str) -> None:
        """A sender whose node the graph does not tell is not heard; where that lasts, whoever waits shall be told."""
        if NAMELESS not in name:
            self._nameless_since = None
            return
        now = time.monotonic()
        if self._nameless_since is None:
            self._nameless_since = now
        elif now - self._nameless_since > _LONG:
            self._refuse(NAMELESS, f"a sender on {self._topic} is not heard: the graph does not tell whose node it is")


_UNTOLD = {"data": b""}
