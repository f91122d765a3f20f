"""The master of time: publishes the state of each instant, waits for all answers, integrates to the next instant."""

from __future__ import annotations

import time
from typing import Any

from rclpy.clock import Clock as RosClock
from rclpy.clock import ClockType
from rclpy.subscription import Subscription
from rosgraph_msgs.msg import Clock
from std_srvs.srv import Trigger

from ev_msgs_py import stamps
from ev_msgs_py.inbox import Arrival
from ev_msgs_py.master_parameters import RECORDER_LAG, MasterParameters
from ev_msgs_py.roles import MASTER, RECORDER_WRITES, ROLES
from ev_msgs_py.signals import WheelTorqueCommand
from ev_msgs_py.stepped_node import QUALITY, SteppedNode
from ev_msgs_py.stepper import WRITERS, Answer, arrival_place
from ev_msgs_py.topics import Topic
from ev_msgs_py.wheels import NO_WHEELS
from ev_msgs_py.wire_format import stamp_alone, stamp_of

_RETRY_PERIOD = 0.05  # s of wall time without an answer after which the state is published once more


class MasterNode(SteppedNode):
    """Plays the plant and drives the graph through time; services pause, resume, step and reset."""

    extra_parameters = MasterParameters

    def __init__(self, **node_arguments: Any) -> None:
        super().__init__(MASTER, **node_arguments)
        self._clock_publisher = self.create_publisher(Clock, "/clock", QUALITY)
        self._recorded = -1  # stamp up to which the recorder holds everything
        self._paused = False
        self._steps_granted = 0
        self._newest: dict[type, tuple[int, Any]] = {}
        self._order = range(len(self.writers))  # in which the signals of an answer are published
        self._overruns = 0  # realtime steps that came more than one period late
        for name, handler in (
            ("pause", self._on_pause),
            ("resume", self._on_resume),
            ("step", self._on_step),
            ("reset", self._on_reset),
        ):
            self.create_service(Trigger, f"~/{name}", handler)
        # For rclpy's own executors; `spinning.spin` calls idle() by itself. The clock is the wall's, not /clock.
        self.create_timer(_RETRY_PERIOD, self.idle, clock=RosClock(clock_type=ClockType.STEADY_TIME))
        self._begin()

    @property
    def time_parameters(self) -> MasterParameters:
        """How time runs, as the parameters say now."""
        return self.configuration.extra

    @property
    def now(self) -> int:
        """Stamp of the present instant, in nanoseconds."""
        return self.stepper.answer.stamp

    def also_reads(self, reads: tuple[type, ...]) -> tuple[type, ...]:
        """Besides its inputs the master follows the recorder, if it shall wait for it."""
        return (*reads, RECORDER_WRITES) if self.configuration.extra.await_recorder else reads

    def wanted(self) -> tuple[type, ...]:
        """The missing inputs, or the recorder's progress if only that is behind."""
        missing = super().wanted()
        return missing if missing or self._recorder_keeps_up() else (RECORDER_WRITES,)

    def awaits(self) -> Subscription:
        """The input that arrives last, also while the next step is only waiting for its time."""
        wanted = self.wanted() or self.stepper.reads
        return self.readers[wanted[0] if len(wanted) == 1 else max(wanted, key=arrival_place)].subscription

    def wake_up_within(self) -> float:
        """Seconds until the next instant is due if nothing else holds it back, at most the period of retries."""
        if self._may_advance_in_time() and (self.realtime or self.time_parameters.real_time_factor > 0):
            return min(max(self._due() - time.monotonic(), 0.0), _RETRY_PERIOD)
        return _RETRY_PERIOD

    def receive(self, topic: Topic, message: bytes) -> None:
        """Take an input, or note how far the recorder is."""
        if topic.signal is RECORDER_WRITES:
            held = stamp_of(message)
            if held <= self.now:  # else it was said of the run before a reset
                self._recorded = max(self._recorded, held)
            self._advance_where_due()
        elif self.realtime:
            received = self.unpacked(topic, message)
            if received is not None:
                if topic.signal not in self._newest:
                    self._pace_from_here()  # realtime begins when the last input has come
                self._newest[topic.signal] = received
        else:
            super().receive(topic, message)

    def arrived(self, topic: Topic, stamp: int, arrival: Arrival) -> None:
        """Integrate when all inputs are there; an input that is known already needs no answer from the master."""
        if arrival is Arrival.NEW:
            self._advance_where_due()

    def idle(self) -> None:
        """Advance if time is due, publish the state again if answers are late, and name the nodes that are silent."""
        self._advance_where_due()
        wall = time.monotonic()
        under_way = self.realtime and self._has_inputs_to_hold()
        if self.done or self._rests() or under_way or wall - self._published < _RETRY_PERIOD:
            return
        if self.stepper.inbox.complete() is None or not self._recorder_keeps_up():
            self._put_awaited_signals_first()
            self._publish(self.stepper.answer)
            if wall - max(self._reached, self._named) > self.time_parameters.answer_timeout:
                self._name_the_silent()
                self._named = wall

    def reconfigured(self) -> None:
        """Time goes on from here at its new pace."""
        self._pace_from_here()

    def _begin(self) -> None:
        self._recorded = -1
        self._newest.clear()
        self._steps_granted = 0
        self._named = 0.0  # wall time when silent nodes were looked for
        self._silence = ""  # what was said of them
        self._publish(self.stepper.begin_run())
        self._reached = self._published
        self._pace_from_here()

    def _put_awaited_signals_first(self) -> None:
        """Publish first what most nodes listen to: their step goes on while the rest is being published."""
        writers = list(self.writers.items())
        place_of = [(-writer.publisher.get_subscription_count(), arrival_place(signal)) for signal, writer in writers]
        self._order = sorted(range(len(writers)), key=lambda n: place_of[n])

    def _publish(self, answer: Answer) -> None:
        for place in self._order:
            signal = answer.signals[place]
            self.writers[type(signal)].write(answer.stamp, signal)
        self._clock_publisher.publish(stamp_alone(answer.stamp))
        self._published = time.monotonic()
        self.pass_notes_on()

    def _due(self) -> float:
        """Wall time at which the next instant is due."""
        factor = 1.0 if self.realtime else self.time_parameters.real_time_factor
        ahead = stamps.to_seconds(self.now + self.stepper.period - self._start_stamp)
        return self._start_wall + ahead / factor

    def _recorder_keeps_up(self) -> bool:
        if not self.time_parameters.await_recorder:
            return True
        last = self.now if self._at_end() or self.now == 0 else self.now - RECORDER_LAG * self.stepper.period
        return self._recorded >= last

    def _at_end(self) -> bool:
        end = stamps.from_seconds(self.time_parameters.duration)
        return 0 < end < self.now + self.stepper.period

    def _rests(self) -> bool:
        return self._paused and not self._steps_granted

    def _may_advance(self) -> bool:
        unpaced = not self.realtime and self.time_parameters.real_time_factor == 0
        return self._may_advance_in_time() and (unpaced or time.monotonic() >= self._due())

    def _may_advance_in_time(self) -> bool:
        """Whether the next instant may come as soon as it is due."""
        if self._rests():
            return False
        if self.realtime:
            return self._has_inputs_to_hold()
        return self.stepper.inbox.complete() is not None and self._recorder_keeps_up()

    def _has_inputs_to_hold(self) -> bool:
        """Realtime begins when everything but the torque command, which may be zero, has been heard once."""
        return all(kind in self._newest for kind in self.stepper.reads if kind is not WheelTorqueCommand)

    def _advance_where_due(self) -> None:
        while not self.done and self._may_advance():
            if self._at_end():
                self._end()
                return
            self._steps_granted = max(self._steps_granted - 1, 0)
            overrun = self.realtime and time.monotonic() - self._due() > self.stepper.period / stamps.NANOSECONDS
            self._publish(self._held_step() if self.realtime else self.stepper.step())
            self._reached, self._silence = self._published, ""
            if self.now == self.stepper.period:
                self._pace_from_here()  # the first step has waited for all nodes to come up
            if overrun:
                self._note_overrun()

    def _note_overrun(self) -> None:
        """Time that is lost stays lost: a burst of late steps would be no real time."""
        self._pace_from_here()
        self._overruns += 1
        if self._overruns == 1:
            self.warn(f"realtime: the step to {stamps.to_seconds(self.now)} s came more than a period late")

    def _end(self) -> None:
        self.done = True
        wall = time.monotonic() - self._start_wall
        simulated = stamps.to_seconds(self.now - self._start_stamp)
        steps = (self.now - self._start_stamp) // self.stepper.period
        self.get_logger().info(f"{simulated:g} s simulated in {wall:.3f} s, {steps / wall:.1f} steps/s")
        if self._overruns:
            self.get_logger().warning(f"{self._overruns} steps came more than a period late")

    def _held_step(self) -> Answer:
        """One step with the newest inputs; without a torque command that is fresh enough the torque is zero."""
        inputs = {kind: signal for kind, (_, signal) in self._newest.items()}
        sent, _ = self._newest.get(WheelTorqueCommand, (None, None))
        age_limit = stamps.from_seconds(self.time_parameters.command_timeout)
        if sent is None or self.now - sent > age_limit:
            inputs[WheelTorqueCommand] = WheelTorqueCommand(NO_WHEELS)
        return self.stepper.step_with(self.now, inputs)

    def _name_the_silent(self) -> None:
        """Say whom the run waits for, and again when more is known: a killed node leaves the graph seconds later."""
        names = {name for name, space in self.get_node_names_and_namespaces() if space == self.get_namespace()}
        gone = [role for role in ROLES if role not in names]
        missing = [f"{kind.__name__} of {WRITERS[kind]}" for kind in self.stepper.inbox.missing()]
        waiting = f"waiting for {', '.join(missing or ['the recorder'])} at {stamps.to_seconds(self.now)} s"
        where = f"not in the graph: {', '.join(gone)}" if gone else "all nodes are in the graph, one does not answer"
        if where != self._silence:
            self._silence = where
            self.get_logger().error(f"{waiting} for {time.monotonic() - self._reached:.1f} s; {where}")

    def _on_pause(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._paused, self._steps_granted = True, 0
        return self._done(response, "paused")

    def _on_resume(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._paused = False
        self._pace_from_here()
        return self._done(response, "running")

    def _on_step(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._paused = True
        self._steps_granted += 1
        self._pace_from_here()
        return self._done(response, "one more step granted")

    def _on_reset(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._begin()
        return self._done(response, "time is zero again,")

    def _pace_from_here(self) -> None:
        self._start_wall, self._start_stamp = time.monotonic(), self.now

    def _done(self, response: Trigger.Response, text: str) -> Trigger.Response:
        response.success, response.message = True, f"{text} at {stamps.to_seconds(self.now)} s"
        return response
