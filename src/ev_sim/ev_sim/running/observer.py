"""Looks at a running graph from outside: simulated time and what nodes report."""

from __future__ import annotations

import json
from collections.abc import Mapping
from contextlib import suppress
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.context import Context
from rclpy.node import Node
from rclpy.serialization import deserialize_message

from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.roles import RECORDER, RECORDER_WRITES, ROLES
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.nodes.health import HEALTH
from ev_msgs_py.nodes.reports import NOTED
from ev_msgs_py.nodes.signal_io import HELD, Reader, SignalReader
from ev_msgs_py.nodes.speaker import NAMELESS
from ev_msgs_py.nodes.time_services import TIME
from ev_msgs_py.nodes.timing import TIMING
from ev_msgs_py.wire.layout import MessageError
from ev_msgs_py.wire.message_format import stamp_of

OBSERVER = "run_scenario"  # its name in the graph


class Observer(Node):
    """Follows the recorder, which speaks seldom, so that looking costs the run next to nothing."""

    def __init__(self, context: Context, namespace: str, name: str = OBSERVER) -> None:
        super().__init__(name, context=context, namespace=namespace, start_parameter_services=False)
        self.time = 0.0
        self.warnings: list[str] = []
        self.timing: dict[str, Any] = {}  # how well real time was kept, as the master says at its end
        self.rests = False  # whether a service has stopped time
        self._words: list[str] = []
        self._noted: list[str] = []
        self._once: dict[str, str] = {}
        self._progress = SignalReader(self, TOPICS[RECORDER_WRITES], self._note_progress, lambda *_: None)
        self._nodes: dict[bytes, tuple[str, str]] = {}  # namespace and name by publisher of /diagnostics
        self._diagnostics = Reader(self, DiagnosticArray, "/diagnostics", self._note_report, self)

    @property
    def notes(self) -> tuple[str, ...]:
        """What nodes note, and once for each node or topic that its messages were refused."""
        return (*self._noted, *self._once.values())

    def new_words(self) -> tuple[str, ...]:
        """What is to be said at once: that time was stopped, or goes on."""
        words, self._words = tuple(self._words), []
        return words

    def look(self) -> None:
        """Take what has come since the last look, the many messages of a stranger included: looks are rare."""
        for reader in (self._progress, self._diagnostics):
            while (message := reader.take(HELD)) is not None:
                reader.receive(message)

    def _note_progress(self, message: bytes) -> None:
        with suppress(MessageError):
            self.time = stamps.to_seconds(stamp_of(message))

    def _note_report(self, message: bytes) -> None:
        with suppress(RuntimeError):  # what cannot be read
            for status in deserialize_message(message, DiagnosticArray).status:
                self._note(status)

    def admits(self, info: Mapping[str, Any]) -> bool:
        """Whether a report is none of a node that has nothing to do with the run; its last word may have left alone."""
        gid = (info.get("publisher_gid") or {}).get("data")
        if gid not in self._nodes:
            for end in self.get_publishers_info_by_topic("/diagnostics"):
                self._nodes[bytes(end.endpoint_gid)] = end.node_namespace, end.node_name
        space, name = self._nodes.get(gid, (self.get_namespace(), RECORDER))
        return (space == self.get_namespace() and name in (*ROLES, RECORDER)) or NAMELESS in name

    def _note(self, status: DiagnosticStatus) -> None:
        if status.name.endswith(HEALTH) or status.hardware_id:  # of a device: its node notes what is latched
            return
        if status.name.endswith(TIMING):
            self.timing = json.loads(next(value.value for value in status.values if value.key == TIMING))
            return
        text = f"{status.name}: {status.message}"
        if status.name.endswith(TIME):
            self.rests = "paused" in status.message
            self._words.append(text)
            return
        once = [value.value for value in status.values if value.key == NOTED]
        if once:
            self._once.setdefault(once[0], text)
        else:
            (self._noted if status.level == DiagnosticStatus.OK else self.warnings).append(text)
