"""From instant to instant as far as the schedule allows, services that stop time, and whom a run waits for."""

from __future__ import annotations

import time
from collections.abc import Callable

from rclpy.node import Node
from std_srvs.srv import Trigger

from ev_core.lockstep.stepper import WRITERS, Answer, Stepper
from ev_core.nodes.master.schedule import Schedule
from ev_core.nodes.reports import Reports
from ev_core.nodes.runner_line import TIME_SERVICE, Word
from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.roles import REQUIRED, ROLES


class Silence:
    """Names the nodes that do not answer, and again when more is known: a killed one leaves the graph seconds later."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self.answered()

    def answered(self) -> None:
        """A step was taken; the clock is read when nothing comes after it."""
        self._since: float | None = None
        self._said: tuple[object, ...] = ()

    def name_after(self, timeout: float, missing: tuple[type, ...], now: int) -> None:
        """Say who is missing at a stamp, once every `timeout` seconds of wall time."""
        wall = time.monotonic()
        if self._since is None:
            self._since = self._named = wall
        if wall - self._named <= timeout:
            return
        self._named = wall
        space = self._node.get_namespace()
        there = {name for name, where in self._node.get_node_names_and_namespaces() if where == space}
        wanted = {*REQUIRED, *(WRITERS[kind] for kind in missing)}
        gone = [role for role in ROLES if role in wanted and role not in there]
        where = f"not in the graph: {', '.join(gone)}" if gone else "all nodes are in the graph, one does not answer"
        if (where, missing) != self._said:
            self._said = where, missing
            waits = ", ".join([f"{kind.__name__} of {WRITERS[kind]}" for kind in missing] or ["the recorder"])
            at = stamps.to_seconds(now)
            self._node.get_logger().error(f"waiting for {waits} at {at} s for {wall - self._since:.1f} s; {where}")


class Advance:
    """Steps the master's part whenever the next instant has come; `stepped` is given its output then."""

    def __init__(
        self, stepper: Stepper, schedule: Schedule, stepped: Callable[[Answer], None], warn: Callable[[str], None]
    ) -> None:
        self._stepper, self._schedule, self._stepped, self._warn = stepper, schedule, stepped, warn
        self.ended = False

    def where_due(self) -> None:
        """Take all steps that may be taken now."""
        schedule, realtime = self._schedule, self._schedule.realtime
        while not self.ended and schedule.has_inputs:
            late = schedule.lateness
            if late < 0.0:
                return
            if schedule.at_end:
                self.ended = True
                return
            answer = self._held_step() if realtime else self._stepper.step()
            assert answer is not None, "the schedule lets time go on only with all inputs"
            if schedule.now == self._stepper.period:
                schedule.pace_from_here()  # the first step has waited for all nodes to come up
            self._stepped(answer)
            if realtime:
                schedule.timing.stepped(late)
                if late > stamps.to_seconds(self._stepper.period):
                    self._note_overrun()

    def _held_step(self) -> Answer:
        """One step with the newest inputs; without a torque command that is fresh enough the torque is zero."""
        now = self._schedule.now
        return self._stepper.step_with(now + self._stepper.inbox.run, self._schedule.held_inputs(now))

    def _note_overrun(self) -> None:
        """A burst of late steps would be no real time."""
        self._schedule.lose_what_is_late()
        self._schedule.timing.overruns += 1
        if self._schedule.timing.overruns == 1:
            at = stamps.to_seconds(self._schedule.now)
            self._warn(f"realtime: the step to {at} s came more than a period late")

    @property
    def summary(self) -> str:
        """What was simulated, how fast, and how often too late."""
        overruns = self._schedule.timing.overruns
        late = f", {overruns} steps came more than a period late" if overruns else ""
        return self._schedule.summary + late


TIME_SERVICES = ("pause", "resume", "step", "reset")


class TimeServices:
    """pause, resume, step and reset of a node, by std_srvs/Trigger.

    `now()` is the present instant; `begin()` begins a new run; `rest()` is called when time comes to stand still and
    `go_on()` when it may go on; `reports` is given each call that was answered.
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
        self._reports.tell(TIME_SERVICE, response.message, values)
        self._reports.runner.tell(Word(TIME_SERVICE, response.message, values=values))
        return response
