"""What a node says besides its signals: in its log and in /diagnostics."""

from __future__ import annotations

import time
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.node import Node

REFUSED = "refused"  # key of a diagnostic value: what is ignored, without harm to the run
_NAMED = 20  # of what is refused; more than these are counted only
_LOOK_PERIOD = 0.1  # s of wall time between looks at what a part notes


class Reports:
    """Says each thing once, and passes on what a part notes of the run."""

    def __init__(self, node: Node, role: str) -> None:
        self._node = node
        self._role = role
        self._publisher = node.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self._part: Any = None
        self._said: set[str] = set()
        self._refused: set[str] = set()
        self._next_look = 0.0

    def warn(self, text: str) -> None:
        """Say something in the log and in /diagnostics: the run may not be reproducible."""
        self._node.get_logger().warning(text)
        self._diagnose(DiagnosticStatus.WARN, text)

    def refuse(self, what: str, text: str) -> None:
        """Say, once of each node or topic, that its messages are refused: that costs time, and changes no number."""
        if what in self._refused or len(self._refused) >= _NAMED:
            return
        self._refused.add(what)
        self._node.get_logger().warning(text)
        self._diagnose(DiagnosticStatus.WARN, text, KeyValue(key=REFUSED, value=what))

    def pass_on_now_and_then(self, part: Any) -> None:
        """As `pass_on`, unless the last look was a moment ago: a part is asked much less often than it steps."""
        if time.monotonic() >= self._next_look:
            self.pass_on(part)

    def pass_on(self, part: Any) -> None:
        """Say what a part notes for the first time, as OK; a new part begins anew."""
        self._next_look = time.monotonic() + _LOOK_PERIOD
        if part is not self._part:
            self._part, self._said = part, set()
        for text in part.notes():
            if text not in self._said:
                self._said.add(text)
                self._node.get_logger().info(text)
                self._diagnose(DiagnosticStatus.OK, text)

    def _diagnose(self, level: bytes, text: str, *more: KeyValue) -> None:
        status = DiagnosticStatus(level=level, name=self._node.get_fully_qualified_name(), message=text)
        status.values = [KeyValue(key="role", value=self._role), *more]
        report = DiagnosticArray(status=[status])
        report.header.stamp = self._node.get_clock().now().to_msg()
        self._publisher.publish(report)
