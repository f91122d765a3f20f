"""The services that stop time, let it run, grant one step, and begin again."""

from __future__ import annotations

from collections.abc import Callable

from rclpy.node import Node
from std_srvs.srv import Trigger

from ev_core.nodes.reports import Reports
from ev_core.nodes.runner_line import TIME, Word
from ev_msgs_py.contract import stamps

TIME_SERVICES = ("pause", "resume", "step", "reset")


class TimeServices:
    """pause, resume, step and reset of a node, by std_srvs/Trigger.

    `now()` is the present instant; `begin()` begins a new run; `rest()` is called when time comes to stand still and
    `go_on()` when it may go on; `reports` is told of each call that was answered.
    """

    def __init__(
        self,
        node: Node,
        now: Callable[[], int],
        begin: Callable[[], None],
        rest: Callable[[], None],
        go_on: Callable[[], None],
        reports: Reports,
    ) -> None:
        self._now, self._begin, self._rest, self._go_on, self._reports = now, begin, rest, go_on, reports
        self.paused = False
        self._granted = 0
        for name, handler in zip(TIME_SERVICES, (self._pause, self._resume, self._step, self._reset), strict=True):
            node.create_service(Trigger, f"~/{name}", handler)

    def rests(self) -> bool:
        """Whether time stands still."""
        return self.paused and not self._granted

    def took_step(self) -> None:
        """One of the granted steps is taken."""
        self._granted = max(self._granted - 1, 0)
        if self.rests():
            self._rest()

    def _pause(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self.paused, self._granted = True, 0
        self._rest()
        return self._done(response, "paused")

    def _resume(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        if self.rests():
            self._go_on()
        self.paused = False
        return self._done(response, "running")

    def _step(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        if self.rests():
            self._go_on()
        self.paused = True
        self._granted += 1
        return self._done(response, "one more step granted")

    def _reset(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._granted = 0
        self._begin()
        if self.paused:
            self._rest()
        return self._done(response, "time is zero again,")

    def _done(self, response: Trigger.Response, text: str) -> Trigger.Response:
        response.success, response.message = True, f"{text} at {stamps.to_seconds(self._now())} s"
        values = {"rests": self.paused}
        self._reports.tell(TIME, response.message, values)
        self._reports.runner.tell(Word(TIME, response.message, values=values))
        return response
