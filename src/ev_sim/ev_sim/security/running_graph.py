"""What the nodes of the running graph really do, to be held against their permissions."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from rclpy.node import Node

from ev_sim.security.permissions import Permissions


def permissions_in_use(observer: Node, namespace: str) -> dict[str, Permissions]:
    """Topics and services of every node in a namespace, as discovery knows them now."""
    return {
        name: Permissions(
            name,
            publishes=_names(observer.get_publisher_names_and_types_by_node(name, namespace)),
            subscribes=_names(observer.get_subscriber_names_and_types_by_node(name, namespace)),
            serves=_names(observer.get_service_names_and_types_by_node(name, namespace)),
        )
        for name, space in observer.get_node_names_and_namespaces()
        if space == (namespace or "/") and name != observer.get_name()
    }


def violations(allowed: Mapping[str, Permissions], used: Iterable[Permissions]) -> tuple[str, ...]:
    """One line for each thing that a node does without being allowed to; an unknown node may do nothing."""
    nothing = frozenset[str]()
    return tuple(
        line
        for each in used
        for line in allowed.get(each.node, Permissions(each.node, nothing, nothing, nothing)).lacks(each)
    )


def _names(found: list[tuple[str, list[str]]]) -> frozenset[str]:
    return frozenset(name for name, _ in found)
