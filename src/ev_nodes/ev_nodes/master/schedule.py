"""When the master of time may go on: inputs and recorder, the pace, the services that stop time, the end."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from rclpy.node import Node
from std_srvs.srv import Trigger

from ev_core.lockstep.inbox import NEVER
from ev_core.lockstep.stepper import Answer, Stepper
from ev_msgs_py.contract import stamps
from ev_nodes.master.real_time import RECORDER_LAG, FadingInputs, MasterParameters, Timing
from ev_nodes.stepping.reports import Reports
from ev_nodes.stepping.runner_line import TIME_SERVICE, Word

TIME_SERVICES = {  # the text by which each reports what it has done
    "pause": "paused",
    "resume": "running",
    "step": "one more step granted",
    "reset": "time is zero again,",
}


class Pace:
    """Simulated time against wall time, which both count from the last call of `start`.

    The clock is monotonic. Time lost since `go_on` counts in the summary, but no instant is due
    earlier for it.
    """

    def __init__(self) -> None:
        self.start(0)

    def start(self, stamp: int) -> None:
        """Begin to count both times here."""
        self._rests: float | None = None
        self.go_on(stamp)
        self._begun = self._wall, self._stamp

    def rest(self) -> None:
        """Let both times stand still until `resume`."""
        if self._rests is None:
            self._rests = time.monotonic()

    def go_on(self, stamp: int) -> None:
        """Let the next instants be due as if this one were in time."""
        self._wall, self._stamp = time.monotonic(), stamp

    def resume(self, stamp: int) -> None:
        """Go on after a rest, which counts nowhere."""
        self.go_on(stamp)
        if self._rests is not None:
            self._begun = self._begun[0] + self._wall - self._rests, self._begun[1]
            self._rests = None

    def due(self, stamp: int, factor: float) -> float:
        """Wall time [s] at which an instant is due.

        `factor` is simulated over wall time, above zero.
        """
        return self._wall + stamps.to_seconds(stamp - self._stamp) / factor

    def summary(self, stamp: int, period: int) -> str:
        """Simulated time up to an instant, and how fast it was simulated."""
        begun, first = self._begun
        wall, simulated = (self._rests or time.monotonic()) - begun, stamp - first
        return (
            f"{stamps.to_seconds(simulated):g} s simulated in {wall:.3f} s,"
            f" {simulated // period / wall:.1f} steps/s"
        )


class Schedule:
    """The present instant and what holds time back; `parameters` are those of the master now."""

    def __init__(self, stepper: Stepper, realtime: bool, parameters: MasterParameters) -> None:
        self._stepper = stepper
        self.realtime = realtime
        self.held = FadingInputs(stepper.reads)
        self.timing = Timing(stepper.reads)
        self._pace = Pace()
        self._recorded = -1  # stamp up to which the recorder holds everything
        self.paused = False  # by a service
        self._granted = 0  # steps that a service lets pass while time is paused
        self.follow(parameters)

    def follow(self, parameters: MasterParameters) -> None:
        """Let time go on from here by other parameters."""
        self._await_recorder = parameters.await_recorder
        self._end = stamps.from_seconds(parameters.duration)
        self._factor = 1.0 if self.realtime else parameters.real_time_factor
        self._parameters = parameters
        self.lose_what_is_late()

    @property
    def now(self) -> int:
        """The present instant, in nanoseconds since the run began."""
        answered = self._stepper.answered
        return 0 if answered == NEVER else answered - self._stepper.inbox.run

    def begin(self) -> None:
        """Begin a new run."""
        self._recorded, self._granted = -1, 0
        self.held.clear()
        self.timing = Timing(self._stepper.reads)
        self.pace_from_here()
        if self.paused:
            self._pace.rest()

    def pace_from_here(self) -> None:
        """Count wall time and simulated time from now on."""
        self._pace.start(self.now)

    @property
    def rests(self) -> bool:
        """True while a service has stopped time."""
        return self.paused and not self._granted

    def pause(self) -> None:
        """Stop time."""
        self.paused, self._granted = True, 0
        self._pace.rest()

    def resume(self) -> None:
        """Let time go on: the pause makes no step late and no command older."""
        if self.rests:
            self._pace.resume(self.now)
            self.held.came_now()
            self.timing.rested()
        self.paused = False

    def grant_step(self) -> None:
        """Stop time after one more step."""
        self.resume()
        self.paused = True
        self._granted += 1

    def took_step(self) -> None:
        """Count one of the granted steps as taken."""
        self._granted = max(self._granted - 1, 0)
        if self.rests:
            self._pace.rest()

    def lose_what_is_late(self) -> None:
        """Give up the wall time that was lost: no later step catches up."""
        self._pace.go_on(self.now)

    def note_recorded(self, stamp: int) -> None:
        """Note that the recorder holds everything up to a stamp, if it is one of this run.

        A stamp ahead of the present is not: the recorder has yet to see that another master counts
        from zero again.
        """
        instant = stamp - self._stepper.inbox.run
        if instant % self._stepper.period == 0 and instant <= self.now:
            if self._recorded < 0:
                self._begin_here()
            self._recorded = max(self._recorded, instant)

    def held_step(self) -> Answer:
        """Take one step of real time with the newest inputs.

        The torque of an old command has faded.
        """
        now, period = self.now, self._stepper.period
        share = self.held.share(now, period, self._parameters)
        self.timing.without_command += share < 1.0
        inputs = self.held.at(share, self._parameters.command_loss_brake_torque)
        return self._stepper.step_with(now + self._stepper.inbox.run, inputs)

    def hold(self, kind: type, stamp: int, numbers: Sequence[float]) -> bool:
        """Keep an input of real time, which begins when all have come once.

        False if no run explains its stamp.
        """
        waited = not self.all_are_here
        instant = stamp - self._stepper.inbox.run
        # A role that integrates publishes the next instant already.
        limit = self.now + 2 * self._stepper.period if instant % self._stepper.period == 0 else -1
        if not self.held.take(kind, instant, numbers, limit):
            newest = self.held.stamp_of(kind)
            self.timing.refused[kind] += instant != newest  # a repetition is no refused input
            is_old = 0 <= instant <= newest and instant % self._stepper.period == 0
            return is_old or self._is_of_another_run(stamp)
        self.timing.arrival[kind].add(time.monotonic() - self._pace.due(instant, self._factor))
        if waited:
            self._begin_here()
        return True

    def _is_of_another_run(self, stamp: int) -> bool:
        """True for a message that was still under way when time was reset."""
        above = stamp % self._stepper.period
        return above != self._stepper.inbox.run and above % stamps.RUN == 0 and above < stamps.RUNS

    def _begin_here(self) -> None:
        """Begin the pace here: a step that has waited for other nodes is not late."""
        self.pace_from_here()
        self.held.came_now()

    @property
    def missing(self) -> tuple[type, ...]:
        """The inputs without which the next step cannot be taken."""
        return self.held.missing if self.realtime else self._stepper.inbox.missing()

    @property
    def all_are_here(self) -> bool:
        """True if the next step has its inputs, and the recorder is near enough."""
        if self.realtime:
            complete = not self.held.missing
        else:
            complete = self._stepper.inbox.complete() is not None
        return complete and self.recorder_keeps_up

    @property
    def recorder_keeps_up(self) -> bool:
        """True if the recorder is near enough.

        At the first and at the last instant it must have everything. Real time no longer waits for
        the recorder once the recorder has begun.
        """
        if not self._await_recorder or (self.realtime and self._recorded >= 0):
            return True
        ends = self.at_end or self.now == 0
        lag = 0 if ends else RECORDER_LAG * self._stepper.period
        return self._recorded >= self.now - lag

    @property
    def recorder_is_behind(self) -> bool:
        """True until a recorder confirms that it holds the present instant."""
        return self._recorded < self.now

    @property
    def at_end(self) -> bool:
        """True at the last instant."""
        return 0 < self._end < self.now + self._stepper.period

    @property
    def has_inputs(self) -> bool:
        """True if the next instant may come as soon as it is due."""
        return self.all_are_here and not self.rests

    @property
    def free_until(self) -> int:
        """Stamp up to which time goes on as soon as all inputs are there.

        -1 if the clock matters.
        """
        if self.paused or self.realtime or self._factor:
            return -1
        free = self._end - self._stepper.period if self._end else stamps.LAST_EXACT
        if self._await_recorder:
            free = min(free, self._recorded + RECORDER_LAG * self._stepper.period)
        return free + self._stepper.inbox.run

    @property
    def lateness(self) -> float:
        """Wall time since the next instant was due [s], negative before; zero without a pace."""
        if self._factor == 0.0:
            return 0.0
        return time.monotonic() - self._pace.due(self.now + self._stepper.period, self._factor)

    @property
    def due_within(self) -> float:
        """Seconds until the next instant if it only waits for its time, else infinity.

        In lockstep an input that completes a step is followed by the step; in real time one may
        have become due since.
        """
        late = self.lateness
        if not self.has_inputs or self.at_end:
            return math.inf
        return -late if late < 0.0 else 0.0 if self.realtime else math.inf

    @property
    def summary(self) -> str:
        """Simulated time, its speed, and the number of late steps."""
        overruns = self.timing.overruns
        late = f", {overruns} steps came more than a period late" if overruns else ""
        return self._pace.summary(self.now, self._stepper.period) + late


def serve_time(node: Node, schedule: Schedule, reset: Callable[[], None], reports: Reports) -> None:
    """Serve pause, resume, step and reset by std_srvs/Trigger; each call is reported."""

    def serve(
        change: Callable[[], None], done: str, _: Trigger.Request, response: Trigger.Response
    ) -> Any:
        change()
        response.success, response.message = True, f"{done} at {stamps.to_seconds(schedule.now)} s"
        values = {"rests": schedule.paused}
        reports.tell(TIME_SERVICE, response.message, values)
        reports.runner.tell(Word(TIME_SERVICE, response.message, values=values))
        return response

    changes = schedule.pause, schedule.resume, schedule.grant_step, reset
    for (name, done), change in zip(TIME_SERVICES.items(), changes, strict=True):
        node.create_service(Trigger, f"~/{name}", partial(serve, change, done))
