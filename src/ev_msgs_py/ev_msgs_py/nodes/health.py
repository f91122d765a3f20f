"""How a node is doing, in /diagnostics once a second of wall time."""

from __future__ import annotations

import time
from typing import Any

from rclpy.clock import Clock as RosClock
from rclpy.clock_type import ClockType

from ev_msgs_py.contract import frame
from ev_msgs_py.contract.signals import WheelTorqueCommand, WheelTorqueRequest
from ev_msgs_py.lockstep.inbox import Arrival

HEALTH = "health"  # what the name of its status ends with
LOST = ".lost."  # in the names of what laws keep of motors and sensors that they do not trust
_PERIOD = 1.0  # s


class Health:
    """Looks at a stepped node; what it counts costs a step nothing."""

    def __init__(self, node: Any) -> None:
        self._node = node
        self._wall, self._stamp = time.monotonic(), 0
        self.late_answers = 0  # times that the master has published its state again
        node.create_timer(_PERIOD, self._say, clock=RosClock(clock_type=ClockType.STEADY_TIME))

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
