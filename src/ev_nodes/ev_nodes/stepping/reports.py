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

HEALTH = "health"  # the end of the name of its status
# in the names of state by which laws remember motors and sensors that they do not trust
LOST = ".lost."
# key of a diagnostic value: a remark that is made once, and does not make a run less reproducible
NOTED = "noted"
_AT_ONCE = Duration()
_TO_BE_HEARD = 0.002  # s between looks at whether all readers have acknowledged
_PERIOD = 1.0  # s between reports of health
_NAMED = 20  # different notes; more than these are dropped
_PATIENCE = 1.0  # s for the last report to arrive
_LOOK_PERIOD = 0.1  # s of wall time between looks at the notes of a part


def wait_until_heard(
    publisher: Publisher, given_up: float, is_wanted: Callable[[], bool] = lambda: True
) -> None:
    """Wait until everything is acknowledged, up to a time of the monotonic clock, for as long as it is wanted.

    The middleware's own time-out may go by the time of day (`time_of_day`).
    """
    while not publisher.wait_for_all_acked(_AT_ONCE):
        if time.monotonic() >= given_up or not is_wanted():
            return
        time.sleep(_TO_BE_HEARD)


class Health:
    """Watches a stepped node by the numbers that it counts anyway."""

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
        values = {
            "steps per second": steps,
            "real-time factor": steps * period / 1e9,
            **self.counts(),
        }
        self._node.reports.tell(HEALTH, f"{steps:.0f} steps/s", values)

    def counts(self) -> dict[str, Any]:
        """The method, counts of messages, withheld drive torque [N m], motors and sensors that are taken for lost."""
        node = self._node
        found = {
            "method": node.configuration.method.name,
            "late answers": self.late_answers,
            "repeats": node.reception.arrivals[Arrival.REPEATED],
            "refused messages": node.reception.refused,
            "foreign messages": sum(reader.judge.refused for reader in node.readers.values()),
        }
        torques = {WheelTorqueRequest, WheelTorqueCommand}
        if torques <= {*node.stepper.reads, *node.writers} and node.stepper.answer:
            numbers = node.stepper.answer.frame.numbers
            asked = numbers[frame.PLACES[WheelTorqueRequest]][:4]  # the four drive torques
            let = numbers[frame.PLACES[WheelTorqueCommand]][:4]
            found["torque withheld"] = max(abs(a - b) for a, b in zip(asked, let, strict=True))
        law = node.configuration.method.law
        watched = [(i, name) for i, name in enumerate(law.names() if law else ()) if LOST in name]
        if watched:
            state = node.stepper.part.state
            found["lost"] = ", ".join(name for i, name in watched if state[i]) or "nothing"
        return found


class Reports:
    """Reports each thing once, and passes on the notes of a part on the run.

    The length of a report is bounded: all values of a parameter that was changed, or names of
    strangers, may be of any length, and the line to the runner takes no more than a socket does.
    """

    def __init__(self, node: Node, role: str) -> None:
        self._node = node
        self._role = role
        self.runner = RunnerLine()
        self._publisher = node.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self._part: Any = None
        self._reported: set[str] = set()
        self._noted: set[str] = set()
        self._warned: set[str] = set()
        self._unheard: list[tuple[str, tuple[KeyValue, ...]]] = []
        self._next_look = 0.0

    def warn(self, text: str) -> None:
        """Report in the log and in /diagnostics why the run may not be reproducible."""
        text = shown(text, LINE)
        self._node.get_logger().warning(text)
        self.runner.tell(Word(WARNING, text))
        self._unheard.append((text, ()))
        self._say_unheard()

    def warn_once(self, what: str, text: str) -> None:
        """Report a thing of this name once, as `warn` does."""
        if what not in self._warned:
            self._warned.add(what)
            self.warn(text)

    def note(self, what: str, text: str) -> None:
        """Report, once of each node or topic, a thing that may cost time and changes no number: refused messages."""
        what, text = shown(what), shown(text, LINE)
        if what in self._noted or len(self._noted) >= _NAMED:
            return
        self._noted.add(what)
        self._node.get_logger().warning(text)
        self.runner.tell(Word(NOTE, text, what))
        self._unheard.append((text, (KeyValue(key=NOTED, value=what),)))
        self._say_unheard()

    def _say_unheard(self) -> None:
        """Publish what waits until a node that subscribes has found this one."""
        if self._unheard and self._publisher.get_subscription_count():
            for text, more in self._unheard:
                self._diagnose(DiagnosticStatus.WARN, text, *more)
            self._unheard.clear()

    def pass_on_now_and_then(self, part: Any) -> None:
        """Call `pass_on`, unless the last look was a moment ago: a part is asked much less often than it steps."""
        if time.monotonic() >= self._next_look:
            self.pass_on(part)

    def pass_on(self, part: Any) -> None:
        """Report as OK each note of a part when it appears for the first time.

        A new part starts from none.
        """
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
        """Publish numbers about the run, if /diagnostics has subscribers.

        `what` ends the name of their status.
        """
        if self._publisher.get_subscription_count():
            more = [KeyValue(key=key, value=str(value)) for key, value in values.items()]
            self._diagnose(DiagnosticStatus.OK, text, *more, name=f": {what}")

    def wait_until_heard(self) -> None:
        """Wait for subscribers to receive the last report: it is lost if the process ends too soon."""
        wait_until_heard(self._publisher, time.monotonic() + _PATIENCE)

    def _diagnose(self, level: bytes, text: str, *more: KeyValue, name: str = "") -> None:
        status = DiagnosticStatus(
            level=level, name=self._node.get_fully_qualified_name() + name, message=text
        )
        status.values = [KeyValue(key="role", value=self._role), *more]
        report = DiagnosticArray(status=[status])
        report.header.stamp = self._node.get_clock().now().to_msg()
        self._publisher.publish(report)
