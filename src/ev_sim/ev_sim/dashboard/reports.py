"""What nodes say in /diagnostics, in words for a page. The graph tells of whom, and anybody may call himself so."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.node import Node
from rclpy.serialization import deserialize_message

from ev_core.nodes.reports import HEALTH, NOTED
from ev_core.nodes.runner_line import TIME_SERVICE, TIMING
from ev_core.nodes.signal_io import HELD, Reader
from ev_msgs_py.contract.roles import RECORDER, ROLES
from ev_msgs_py.refusal import shown

_MOST = 1000  # different ones that are remembered


class Reported:
    """Hears the nodes of a graph whose names are those of roles."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._said: set[str] = set()
        self._new: list[tuple[str, bool]] = []
        self._names: dict[bytes, tuple[str, str]] = {}  # namespace and name by publisher
        self._reader = Reader(node, DiagnosticArray, "/diagnostics", self._note, self)

    def look(self) -> list[tuple[str, bool]]:
        """What was said since the last look, and whether it was about time alone; anything else is told once."""
        while (message := self._reader.take(HELD)) is not None:
            self._reader.receive(message)
        new, self._new = self._new, []
        return new

    def admits(self, info: Mapping[str, Any]) -> bool:
        """Whether a report is one of a node with the name of a role, as the graph tells it."""
        gid = (info.get("publisher_gid") or {}).get("data")
        if gid not in self._names:
            self._names = {
                bytes(end.endpoint_gid): (end.node_namespace, end.node_name)
                for end in self._node.get_publishers_info_by_topic("/diagnostics")
            }
        space, name = self._names.get(gid, ("", ""))
        return space == self._node.get_namespace() and name in (*ROLES, RECORDER)

    def _note(self, message: bytes) -> None:
        with suppress(RuntimeError):  # what cannot be read
            for status in deserialize_message(message, DiagnosticArray).status:
                self._note_status(status)

    def _note_status(self, status: DiagnosticStatus) -> None:
        if status.name.endswith((HEALTH, TIMING)) or status.hardware_id:  # of a device: its node notes what is latched
            return
        text, about_time = shown(f"{status.name}: {status.message}"), status.name.endswith(TIME_SERVICE)
        what = next((shown(value.value) for value in status.values if value.key == NOTED), text)
        if about_time or (what not in self._said and len(self._said) < _MOST):
            self._said.add(what)
            self._new.append((text, about_time))
