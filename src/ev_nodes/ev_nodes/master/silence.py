"""Reasons why nodes do not answer: nodes that are gone, and ends of topics that exchange no messages."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

from rclpy.qos import QoSCompatibility, ReliabilityPolicy, qos_check_compatible

from ev_core.lockstep.stepper import WRITERS
from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.roles import RECORDER, REQUIRED, ROLES
from ev_msgs_py.contract.topics import TOPICS, Topic
from ev_nodes.stepping.signal_io import NAMELESS, full_name


class Misfit(NamedTuple):
    """An end of a topic that exchanges no messages with the others."""

    node: str  # its full name
    line: str  # for the user


def misfits(node: Any, topic: Topic) -> Iterator[Misfit]:
    """Ends of a topic that have another type, or with a quality of service that lets no message pass."""
    name, expected = node.resolve_topic_name(topic.name), topic.message_type
    writer = f"{node.get_namespace().rstrip('/')}/{WRITERS.get(topic.signal, RECORDER)}"
    publishers = _named(node.get_publishers_info_by_topic(name))
    subscriptions = _named(node.get_subscriptions_info_by_topic(name))
    for does, ends in (("publishes", publishers), ("subscribes to", subscriptions)):
        for end in ends:
            if end.topic_type != expected:
                stranger = full_name(end)
                yield Misfit(
                    stranger, f"{stranger} {does} {name} as {end.topic_type}, expected {expected}"
                )
    for publisher in publishers:
        if full_name(publisher) != writer or publisher.topic_type != expected:
            continue
        if publisher.qos_profile.reliability is ReliabilityPolicy.BEST_EFFORT:
            yield Misfit(writer, f"{writer} publishes {name} as best effort, expected reliable")
            continue
        for reader in subscriptions:
            fit, why = qos_check_compatible(publisher.qos_profile, reader.qos_profile)
            if fit == QoSCompatibility.ERROR and reader.topic_type == expected:
                deaf, why = full_name(reader), why.removeprefix("ERROR: ").rstrip(";")
                yield Misfit(deaf, f"{deaf} receives nothing of {name}: {why}")


def _named(ends: Iterable[Any]) -> list[Any]:
    """The ends of nodes that the graph can name by now."""
    return [end for end in ends if NAMELESS not in full_name(end)]


class Silence:
    """Names the nodes that do not answer, and again when more is known: a killed one leaves the graph seconds later.

    `node` is the master of time.
    """

    def __init__(self, node: Any) -> None:
        self._node = node
        self.answered()

    def answered(self) -> None:
        """Note that a step was taken; the clock is read only when nothing comes after it."""
        self._since: float | None = None
        self._reported: tuple[object, ...] = ()

    def name_after(self, timeout: float, missing: tuple[type, ...], now: int) -> None:
        """Log the missing nodes at a stamp, once every `timeout` seconds of wall time."""
        wall = time.monotonic()
        if self._since is None:
            self._since = self._named = wall
        if wall - self._named <= timeout:
            return
        self._named = wall
        where = "; ".join(
            self.reasons(missing) or ["all nodes are in the graph, one does not answer"]
        )
        if (where, missing) != self._reported:
            self._reported = where, missing
            waits = ", ".join(
                [f"{kind.__name__} of {WRITERS[kind]}" for kind in missing] or ["the recorder"]
            )
            at = stamps.to_seconds(now)
            self._node.get_logger().error(
                f"waiting for {waits} at {at} s for {wall - self._since:.1f} s; {where}"
            )

    def reasons(self, missing: tuple[type, ...]) -> list[str]:
        """Reasons why these signals do not come, as far as the graph knows: a node waits for others, too."""
        space = self._node.get_namespace()
        nodes = self._node.get_node_names_and_namespaces()
        there = {name for name, where in nodes if where == space}
        wanted = {*REQUIRED, *(WRITERS.get(kind, RECORDER) for kind in missing)}
        if gone := [role for role in ROLES if role in wanted and role not in there]:
            elsewhere = sorted(
                f"{where.rstrip('/')}/{name}" for name, where in nodes if name in gone
            )
            hint = f" (but {', '.join(elsewhere)}, expected in {space})" if elsewhere else ""
            return [f"not in the graph: {', '.join(gone)}{hint}"]
        roles = {f"{space.rstrip('/')}/{role}" for role in ROLES}
        unfit = [each for topic in TOPICS.values() for each in misfits(self._node, topic)]
        return [*self._unpublished(wanted), *(each.line for each in unfit if each.node in roles)]

    def _unpublished(self, wanted: set[str]) -> Iterator[str]:
        """Topics that a role subscribes to, and that the wanted role does not publish."""
        node = self._node
        for kind, topic in TOPICS.items():
            role, name = WRITERS.get(kind), node.resolve_topic_name(topic.name)
            publishers = {end.node_name for end in node.get_publishers_info_by_topic(name)}
            if role not in wanted or role in publishers:
                continue
            if any(end.node_name in ROLES for end in node.get_subscriptions_info_by_topic(name)):
                yield f"{role} has no publisher of {topic.name}"
