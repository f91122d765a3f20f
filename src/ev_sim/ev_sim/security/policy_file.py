"""Permissions as a policy file of SROS 2, of which `ros2 security generate_artifacts` makes keys and signed files."""

from __future__ import annotations

from collections.abc import Iterable
from xml.etree import ElementTree

from ev_sim.security.permissions import Permissions


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
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(policy, encoding="unicode") + "\n"


def _allow(profile: ElementTree.Element, group: str, kind: str, what: str, names: frozenset[str]) -> None:
    if not names:
        return
    allowed = ElementTree.SubElement(profile, group, {what: "ALLOW"})
    for name in sorted(names):
        ElementTree.SubElement(allowed, kind).text = name
