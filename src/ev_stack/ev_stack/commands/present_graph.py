"""Finds the running graph: its ROS domain, its nodes and topics, and the namespace of its master of time."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeVar

import rclpy
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.signals import SignalHandlerOptions

from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.refusal import quoted
from ev_nodes.run_role import NO_LOG_FILE, leave_graph
from ev_nodes.stepping.signal_io import NAMELESS
from ev_stack.recording.outcome import RunFailed
from ev_stack.running.domain import free_domain, reserved_domains

_STABLE = 0.5  # s in which no node has come or gone, after which a look into the graph begins
_PATIENCE = 4.0  # s for a node to be found, which takes up to 3 s by the middleware's own discovery
_GLANCE = 0.02  # s
Found = TypeVar("Found")
_ROS_OWN = ("/parameter_events", "/rosout")


def full_names(node: Node) -> list[str]:
    """The nodes of the graph but this one and hidden ones, sorted."""
    there = node.get_node_names_and_namespaces()
    named = {
        f"{space.rstrip('/')}/{name}"
        for name, space in there
        if not name.startswith("_") or NAMELESS in name
    }
    return sorted(named - {node.get_fully_qualified_name()})


def present_domain() -> int:
    """ROS_DOMAIN_ID, else the domain of the run under way, 0 without one.

    Raises RunFailed if there are several.
    """
    if os.environ.get("ROS_DOMAIN_ID"):
        with free_domain() as domain:
            return domain
    found = reserved_domains()
    if len(found) > 1:
        there = ", ".join(map(str, found))
        raise RunFailed(f"runs are under way in the domains {there}: ROS_DOMAIN_ID=N says which")
    return found[0] if found else 0


@contextmanager
def in_the_graph(name: str) -> Iterator[Node]:
    """A node of our own in the graph, when the others have been found.

    Raises LookupError if there are none.
    """
    domain = present_domain()
    rclpy.init(
        args=["--ros-args", NO_LOG_FILE],
        domain_id=domain,
        signal_handler_options=SignalHandlerOptions.NO,
    )
    try:
        node = Node(name, start_parameter_services=False, enable_rosout=False)
        try:
            if not _found(node):
                others = ", ".join(map(str, reserved_domains())) or "none"
                raise LookupError(
                    f"no nodes are running in ROS domain {domain}; runs are under way in: {others}"
                )
            yield node
        finally:
            leave_graph(node)
    finally:
        rclpy.try_shutdown()


def _found(node: Node) -> bool:
    begun = changed = time.monotonic()
    before: list[str] = []
    while True:
        now, found = time.monotonic(), full_names(node)
        if found != before:
            before, changed = found, now
        # Discovery brings nodes one by one, and a node may be there before its name is.
        if found and now - changed > _STABLE and not any(NAMELESS in each for each in found):
            return True
        # Longer where something was found that still changes.
        if now - begun > _PATIENCE + (_PATIENCE if found else 0.0):
            return bool(found)
        time.sleep(_GLANCE)


def awaited(node: Node, look: Callable[[], Found]) -> Found:
    """Look into the graph until something is found.

    Its LookupError is raised once no node has come or gone for as long as one may take. On a busy
    machine some nodes are found long before the rest, which may be what is looked for.
    """
    changed, before = time.monotonic(), None
    while True:
        try:
            return look()
        except LookupError:
            now, found = time.monotonic(), full_names(node)
            if found != before:
                before, changed = found, now
            if now - changed > _PATIENCE:
                raise
        time.sleep(_GLANCE)


def topics_of(node: Node) -> dict[str, list[str]]:
    """The topics of the graph with their types; that of the topic table comes first."""
    found = {}
    for name, types in sorted(node.get_topic_names_and_types()):
        if name not in _ROS_OWN:
            found[name] = sorted(types, key=lambda kind: kind != _type_by_contract(name))
    return found


def _type_by_contract(name: str) -> str | None:
    return next(
        (topic.message_type for topic in TOPICS.values() if name.endswith(f"/{topic.name}")), None
    )


def type_of(node: Node, name: str) -> str:
    """The type of a topic.

    Raises LookupError if there is no such topic, or if it has several that are none of ours.
    """
    first, *others = awaited(node, lambda: _types_now(node, name))
    if others and first != _type_by_contract(name):
        raise LookupError(f"{name} has several types, expected one: {', '.join((first, *others))}")
    return first


def _types_now(node: Node, name: str) -> list[str]:
    there = topics_of(node)
    if name not in there:
        raise LookupError(f"no topic {quoted(name)}; known: {', '.join(there) or 'none'}")
    return there[name]


def quality_of(node: Node, name: str, depth: int) -> QoSProfile:
    """The quality of service with which a subscription receives what all publishers of a topic send."""
    ends = [end.qos_profile for end in node.get_publishers_info_by_topic(name)]
    quality = QoSProfile(depth=depth)
    # A reliable subscription would get nothing from a publisher that is not reliable.
    if any(end.reliability is ReliabilityPolicy.BEST_EFFORT for end in ends):
        quality.reliability = ReliabilityPolicy.BEST_EFFORT
    # With one volatile publisher, a subscription that asks for lasting messages would get none of
    # it.
    if ends and all(end.durability is DurabilityPolicy.TRANSIENT_LOCAL for end in ends):
        quality.durability = DurabilityPolicy.TRANSIENT_LOCAL
    return quality


def master_namespace(node: Node, wanted: str | None) -> str:
    """The namespace of the master of time, the wanted one where there is one.

    Raises LookupError if there is not just one.
    """
    return awaited(node, lambda: _master_now(node, wanted))


def _master_now(node: Node, wanted: str | None) -> str:
    ending = f"/{MASTER}"
    spaces = [
        each.removesuffix(ending) or "/" for each in full_names(node) if each.endswith(ending)
    ]
    if wanted is not None:
        spaces = [each for each in spaces if each == wanted]
    if len(spaces) != 1:
        there = (
            f"several are there, --namespace says which: {', '.join(spaces)}"
            if spaces
            else "there is none"
        )
        raise LookupError(
            f"no master of time ({MASTER}){f' in {wanted}' if wanted else ''}: {there}"
        )
    return spaces[0]
