"""Permissions of each node: least privilege, from the declaration of the roles."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from xml.etree import ElementTree

from rclpy.node import Node

from ev_msgs_py.contract.roles import MASTER, RECORDED, RECORDER_WRITES, ROLES, Role
from ev_msgs_py.contract.topics import TOPICS
from ev_nodes.master.schedule import TIME_SERVICES
from ev_stack.running.offline import RECORDER

_CLOCK = frozenset({"/clock"})
_LOG = frozenset({"/rosout"})
_REPORTS = frozenset({"/diagnostics"})
_PARAMETER_EVENTS = frozenset({"/parameter_events"})
# Those that rclpy serves in every node with parameters.
_PARAMETER_SERVICES = (
    "describe_parameters",
    "get_parameter_types",
    "get_parameters",
    "get_type_description",
    "list_parameters",
    "set_parameters",
    "set_parameters_atomically",
)


@dataclass(frozen=True, slots=True)
class Permissions:
    """The topics and services of one node, by their full names."""

    node: str
    publishes: frozenset[str]
    subscribes: frozenset[str]
    serves: frozenset[str]

    def lacks(self, other: Permissions) -> tuple[str, ...]:
        """List what the other set has beyond this one, one line each."""
        return tuple(
            f"{self.node} {verb} {name}"
            for verb, allowed, used in (
                ("publishes", self.publishes, other.publishes),
                ("subscribes to", self.subscribes, other.subscribes),
                ("serves", self.serves, other.serves),
            )
            for name in sorted(used - allowed)
        )


def permissions(namespace: str) -> dict[str, Permissions]:
    """Permissions of every role and of the recorder in a namespace such as /ev.

    The runner is not in the graph.
    """
    found = [_of_role(role, namespace) for role in ROLES.values()]
    # The bag holds more than the signals of the contract.
    into_the_bag = _topics(RECORDED, namespace) | _REPORTS | _CLOCK
    found.append(
        _of_node(RECORDER, _topics((RECORDER_WRITES,), namespace), into_the_bag, namespace)
    )
    return {each.node: each for each in found}


def _of_role(role: Role, namespace: str) -> Permissions:
    writes, reads = _topics(role.may_write, namespace), _topics(role.reads, namespace)
    if role.name == MASTER:
        # The master gives time, and may have to wait for the recorder's progress.
        writes, reads = writes | _CLOCK, reads | _topics((RECORDER_WRITES,), namespace)
    own_services = tuple(TIME_SERVICES) if role.name == MASTER else role.services
    return _of_node(role.name, writes, reads, namespace, own_services)


def _of_node(
    name: str,
    writes: frozenset[str],
    reads: frozenset[str],
    namespace: str,
    own_services: tuple[str, ...] = (),
) -> Permissions:
    services = (*_PARAMETER_SERVICES, *own_services)
    serves = frozenset(f"{namespace}/{name}/{service}" for service in services)
    # Every node of rclpy logs and announces its parameters; ours report to /diagnostics as well.
    return Permissions(name, writes | _LOG | _PARAMETER_EVENTS | _REPORTS, reads, serves)


def _topics(signals: tuple[type, ...], namespace: str) -> frozenset[str]:
    return frozenset(f"{namespace}/{TOPICS[signal].name}" for signal in signals)


def policy_file(namespace: str, permissions: Iterable[Permissions]) -> str:
    """The XML text, with one enclave NAMESPACE/NODE for each node."""
    policy = ElementTree.Element("policy", version="0.2.0")
    enclaves = ElementTree.SubElement(policy, "enclaves")
    for each in permissions:
        enclave = ElementTree.SubElement(enclaves, "enclave", path=f"{namespace}/{each.node}")
        profiles = ElementTree.SubElement(enclave, "profiles")
        profile = ElementTree.SubElement(profiles, "profile", ns=namespace or "/", node=each.node)
        _allow(profile, "topics", "topic", "publish", each.publishes)
        _allow(profile, "topics", "topic", "subscribe", each.subscribes)
        _allow(profile, "services", "service", "reply", each.serves)
    ElementTree.indent(policy)
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        + ElementTree.tostring(policy, encoding="unicode")
        + "\n"
    )


def _allow(
    profile: ElementTree.Element, group: str, kind: str, what: str, names: frozenset[str]
) -> None:
    if not names:
        return
    allowed = ElementTree.SubElement(profile, group, {what: "ALLOW"})
    for name in sorted(names):
        ElementTree.SubElement(allowed, kind).text = name


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
    """List each act of a node that it is not permitted, one line each.

    Unknown nodes may do nothing.
    """
    nothing = frozenset[str]()
    return tuple(
        line
        for each in used
        for line in allowed.get(each.node, Permissions(each.node, nothing, nothing, nothing)).lacks(
            each
        )
    )


def _names(found: list[tuple[str, list[str]]]) -> frozenset[str]:
    return frozenset(name for name, _ in found)
