"""From instant to instant, as far as the schedule allows."""

from __future__ import annotations

from collections.abc import Callable

from ev_msgs_py.contract import stamps
from ev_msgs_py.lockstep.stepper import Answer, Stepper
from ev_msgs_py.nodes.schedule import Schedule


class Advance:
    """Steps the master's part whenever the next instant has come; `stepped` is told what it says then."""

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
