"""Looks at a running graph from outside: simulated time and what nodes report."""

from __future__ import annotations

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.context import Context
from rclpy.node import Node
from rclpy.qos import QoSProfile
from std_msgs.msg import Header

from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.roles import RECORDER_WRITES
from ev_msgs_py.contract.topics import TOPICS

OBSERVER = "run_scenario"  # its name in the graph
_LATEST = QoSProfile(depth=1)  # reliable: the last word of the recorder says that the run is complete


class Observer(Node):
    """Follows the recorder, which speaks seldom, so that looking costs the run next to nothing."""

    def __init__(self, context: Context, namespace: str) -> None:
        super().__init__(OBSERVER, context=context, namespace=namespace, start_parameter_services=False)
        self.time = 0.0
        self.warnings: list[str] = []
        self.notes: list[str] = []
        self._progress = self.create_subscription(Header, TOPICS[RECORDER_WRITES].name, lambda message: None, _LATEST)
        self._diagnostics = self.create_subscription(DiagnosticArray, "/diagnostics", lambda message: None, 100)

    def look(self) -> None:
        """Take what has come since the last look."""
        while (taken := self._progress.handle.take_message(Header, False)) is not None:
            self.time = stamps.to_seconds(stamps.read(taken[0].stamp))
        while (taken := self._diagnostics.handle.take_message(DiagnosticArray, False)) is not None:
            for status in taken[0].status:
                texts = self.notes if status.level == DiagnosticStatus.OK else self.warnings
                texts.append(f"{status.name}: {status.message}")
