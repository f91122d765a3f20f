"""Looks at a running graph from outside: simulated time and what nodes report."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.context import Context
from rclpy.node import Node
from rclpy.qos import QoSProfile
from std_msgs.msg import Header

from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.roles import RECORDER, RECORDER_WRITES, ROLES
from ev_msgs_py.contract.topics import QUEUE_DEPTH, TOPICS
from ev_msgs_py.nodes.health import HEALTH
from ev_msgs_py.nodes.reports import NOTED
from ev_msgs_py.nodes.speaker import Speaker
from ev_msgs_py.nodes.time_services import TIME
from ev_msgs_py.nodes.timing import TIMING

OBSERVER = "run_scenario"  # its name in the graph
# The last word of the recorder says that the run is complete: it shall not be lost among those of strangers.
_QUALITY = QoSProfile(depth=20 * QUEUE_DEPTH)


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
        self._progress = self.create_subscription(Header, TOPICS[RECORDER_WRITES].name, lambda message: None, _QUALITY)
        self._recorder = Speaker(self, TOPICS[RECORDER_WRITES].name, RECORDER, lambda *_: None)
        self._nodes: dict[bytes, tuple[str, str]] = {}  # namespace and name by publisher of /diagnostics
        self._diagnostics = self.create_subscription(DiagnosticArray, "/diagnostics", lambda message: None, _QUALITY)

    @property
    def notes(self) -> tuple[str, ...]:
        """What nodes note, and once for each node or topic that its messages were refused."""
        return (*self._noted, *self._once.values())

    def new_words(self) -> tuple[str, ...]:
        """What is to be said at once: that time was stopped, or goes on."""
        words, self._words = tuple(self._words), []
        return words

    def look(self) -> None:
        """Take what has come since the last look."""
        while (taken := self._progress.handle.take_message(Header, False)) is not None:
            if self._recorder.admits(taken[1]):
                self.time = stamps.to_seconds(stamps.read(taken[0].stamp))
        while (taken := self._diagnostics.handle.take_message(DiagnosticArray, False)) is not None:
            if self._speaks_for_the_run(taken[1]):
                for status in taken[0].status:
                    self._note(status)

    def _speaks_for_the_run(self, info: Mapping[str, Any]) -> bool:
        """Whether a report is none of a node that has nothing to do with the run; its last word may have left alone."""
        gid = (info.get("publisher_gid") or {}).get("data")
        if gid not in self._nodes:
            for end in self.get_publishers_info_by_topic("/diagnostics"):
                self._nodes[bytes(end.endpoint_gid)] = end.node_namespace, end.node_name
        space, name = self._nodes.get(gid, (self.get_namespace(), RECORDER))
        return (space == self.get_namespace() and name in (*ROLES, RECORDER)) or "_UNKNOWN_" in name

    def _note(self, status: DiagnosticStatus) -> None:
        if status.name.endswith(HEALTH):
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
