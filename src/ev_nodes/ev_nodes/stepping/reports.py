"""The reports of a node: in its log, in /diagnostics, and to the runner that has started it."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.publisher import Publisher

from ev_core.lockstep.inbox import Arrival
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.signals import WheelTorqueCommand, WheelTorqueRequest
from ev_msgs_py.refusal import LINE, shown
from ev_nodes.stepping.runner_line import NOTE, REMARK, WARNING, RunnerLine, Word

_AT_ONCE = Duration()
_TO_BE_HEARD = 0.002  # s


def wait_until_heard(publisher: Publisher, given_up: float, is_wanted: Callable[[], bool] = lambda: True) -> None:
    """Wait until everything is acknowledged, up to a time of the monotonic clock, for as long as it is wanted.

    The middleware's own time-out may go by the time of day (`time_of_day`).
    """
    while not publisher.wait_for_all_acked(_AT_ONCE) and time.monotonic() < given_up and is_wanted():
        time.sleep(_TO_BE_HEARD)


HEALTH = "health"  # what the name of its status ends with
LOST = ".lost."  # in the names of what laws keep of motors and sensors that they do not trust
_PERIOD = 1.0  # s


class Health:
    """Looks at a stepped node; what it counts costs a step nothing."""

    def __init__(self, node: Any) -> None:
        self._node = node
        self._wall, self._stamp = time.monotonic(), 0
        self.late_answers = 0  # times that the master has published its state again
        node.every(_PERIOD, self._say)

    def _say(self) -> None:
        wall, answer = time.monotonic(), self._node.stepper.answer
        stamp = 0 if answer is None else answer.stamp
        period = self._node.stepper.period
        steps = max(stamp - self._stamp, 0) // period / (wall - self._wall)
        self._wall, self._stamp = wall, stamp
        values = {"steps per second": steps, "real-time factor": steps * period / 1e9, **self.counts()}
        self._node.reports.tell(HEALTH, f"{steps:.0f} steps/s", values)

    def counts(self) -> dict[str, Any]:
        """What has been counted, the method, drive torque that is withheld [N m], motors and sensors taken for lost."""
        node = self._node
        found = {
            "method": node.configuration.method.name,
            "late answers": self.late_answers,
            "repeats": node.reception.arrivals[Arrival.REPEATED],
            "refused messages": node.reception.refused,
            "messages of strangers": sum(reader.speaker.refused for reader in node.readers.values()),
        }
        if {WheelTorqueRequest, WheelTorqueCommand} <= {*node.stepper.reads, *node.writers} and node.stepper.answer:
            numbers = node.stepper.answer.frame.numbers
            asked, let = (numbers[frame.PLACES[kind]][:4] for kind in (WheelTorqueRequest, WheelTorqueCommand))
            found["torque withheld"] = max(abs(a - b) for a, b in zip(asked, let, strict=True))
        law = node.configuration.method.law
        watched = [(i, name) for i, name in enumerate(law.names() if law else ()) if LOST in name]
        if watched:
            state = node.stepper.part.state
            found["lost"] = ", ".join(name for i, name in watched if state[i]) or "nothing"
        return found


NOTED = "noted"  # key of a diagnostic value: what is named once, and does not make a run less reproducible
_NAMED = 20  # of what is noted; more than these are counted only
_PATIENCE = 1.0  # s for the last report to arrive
_LOOK_PERIOD = 0.1  # s of wall time between looks at what a part notes


class Reports:
    """Says each thing once, and passes on what a part notes of the run.

    The length of a report is bounded: all values of a parameter that was changed, or names of strangers, may be of any
    length, and the line to the runner takes no more than a socket does.
    """

    def __init__(self, node: Node, role: str) -> None:
        self._node = node
        self._role = role
        self.runner = RunnerLine()
        self._publisher = node.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self._part: Any = None
        self._reported: set[str] = set()
        self._noted: set[str] = set()
        self._unheard: list[tuple[str, KeyValue]] = []
        self._next_look = 0.0

    def warn(self, text: str) -> None:
        """Say something in the log and in /diagnostics: the run may not be reproducible."""
        text = shown(text, LINE)
        self._node.get_logger().warning(text)
        self.runner.tell(Word(WARNING, text))
        self._diagnose(DiagnosticStatus.WARN, text)

    def note(self, what: str, text: str) -> None:
        """Say, once of each node, topic or the like, what may cost time and changes no number, as refused messages."""
        what, text = shown(what), shown(text, LINE)
        if what in self._noted or len(self._noted) >= _NAMED:
            return
        self._noted.add(what)
        self._node.get_logger().warning(text)
        self.runner.tell(Word(NOTE, text, what))
        self._unheard.append((text, KeyValue(key=NOTED, value=what)))
        self._say_unheard()

    def _say_unheard(self) -> None:
        """A node that has just begun may not have been found yet by those who listen."""
        if self._unheard and self._publisher.get_subscription_count():
            for text, what in self._unheard:
                self._diagnose(DiagnosticStatus.WARN, text, what)
            self._unheard.clear()

    def pass_on_now_and_then(self, part: Any) -> None:
        """As `pass_on`, unless the last look was a moment ago: a part is asked much less often than it steps."""
        if time.monotonic() >= self._next_look:
            self.pass_on(part)

    def pass_on(self, part: Any) -> None:
        """Say what a part notes for the first time, as OK; a new part begins anew."""
        self._next_look = time.monotonic() + _LOOK_PERIOD
        self.runner.send_what_waits()
        self._say_unheard()
        if part is not self._part:
            self._part, self._reported = part, set()
        for text in (shown(each, LINE) for each in part.notes()):
            if text not in self._reported:
                self._reported.add(text)
                self._node.get_logger().info(text)
                self.runner.tell(Word(REMARK, text))
                self._diagnose(DiagnosticStatus.OK, text)

    def tell(self, what: str, text: str, values: Mapping[str, Any]) -> None:
        """Publish numbers about the run, if anybody listens; `what` distinguishes them from the reports."""
        if self._publisher.get_subscription_count():
            more = [KeyValue(key=key, value=str(value)) for key, value in values.items()]
            self._diagnose(DiagnosticStatus.OK, text, *more, name=f": {what}")

    def wait_until_heard(self) -> None:
        """The last word of a process is lost if it ends too soon."""
        wait_until_heard(self._publisher, time.monotonic() + _PATIENCE)

    def _diagnose(self, level: bytes, text: str, *more: KeyValue, name: str = "") -> None:
        status = DiagnosticStatus(level=level, name=self._node.get_fully_qualified_name() + name, message=text)
        status.values = [KeyValue(key="role", value=self._role), *more]
        report = DiagnosticArray(status=[status])
        report.header.stamp = self._node.get_clock().now().to_msg()
        self._publisher.publish(report)
