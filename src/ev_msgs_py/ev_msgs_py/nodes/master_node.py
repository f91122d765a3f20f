"""The master of time: publishes the state of each instant, waits for all answers, integrates to the next instant."""

from __future__ import annotations

import time
from typing import Any

from rclpy.clock import Clock as RosClock
from rclpy.clock import ClockType
from rclpy.subscription import Subscription
from rosgraph_msgs.msg import Clock

from ev_msgs_py import stamps
from ev_msgs_py.lockstep.inbox import Arrival
from ev_msgs_py.lockstep.stepper import Answer, arrival_place
from ev_msgs_py.master_parameters import RECORDER_LAG, MasterParameters
from ev_msgs_py.nodes.held_inputs import HeldInputs
from ev_msgs_py.nodes.pace import Pace
from ev_msgs_py.nodes.signal_io import QUALITY
from ev_msgs_py.nodes.silence import Silence
from ev_msgs_py.nodes.stepped_node import SteppedNode
from ev_msgs_py.nodes.time_services import TimeServices
from ev_msgs_py.roles import MASTER, RECORDER_WRITES
from ev_msgs_py.topics import Topic
from ev_msgs_py.wire.message_format import stamp_alone, stamp_of

_RETRY_PERIOD = 0.05  # s of wall time without an answer after which the state is published once more


class MasterNode(SteppedNode):
    """Plays the plant and drives the graph through time; services pause, resume, step and reset."""

    extra_parameters = MasterParameters

    def __init__(self, **node_arguments: Any) -> None:
        super().__init__(MASTER, **node_arguments)
        self._clock_publisher = self.create_publisher(Clock, "/clock", QUALITY)
        self._pace = Pace()
        self._silence = Silence(self)
        self._held = HeldInputs(self.stepper.reads)
        self._time = TimeServices(self, lambda: self.now, self._begin, self.reconfigured)
        self._order = list(self.writers.values())  # in which the signals of an answer are published
        self._overruns = 0  # realtime steps that came more than one period late
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
        if self._is_paced and self._has_inputs():
            return min(max(self._due() - time.monotonic(), 0.0), _RETRY_PERIOD)
        return _RETRY_PERIOD

    def receive(self, topic: Topic, message: bytes) -> None:
        """Take an input, or note how far the recorder is."""
        if topic.signal is not RECORDER_WRITES and not self.realtime:
            super().receive(topic, message)
            return
        message = self.readable(topic, message)
        if message is None:
            return
        if topic.signal is not RECORDER_WRITES:
            if self._held.take(topic, message):
                self._pace.start(self.now)  # realtime begins when the last input has come
        elif stamp_of(message) <= self.now:  # else it was said of the run before a reset
            self._recorded = max(self._recorded, stamp_of(message))
            self._advance_where_due()

    def arrived(self, topic: Topic, stamp: int, arrival: Arrival) -> None:
        """Integrate when all inputs are there; an input that is known already needs no answer from the master."""
        if arrival is Arrival.NEW:
            self._advance_where_due()

    def idle(self) -> None:
        """Advance if time is due, publish the state again if answers are late, and name the nodes that are silent."""
        self._advance_where_due()
        under_way = self.realtime and self._held.complete
        if self.done or self._time.rests or under_way or time.monotonic() - self._published < _RETRY_PERIOD:
            return
        if self.stepper.inbox.complete() is None or not self._recorder_keeps_up():
            self._put_awaited_signals_first()
            self.publish(self.stepper.answer)
            self._silence.name_after(self.time_parameters.answer_timeout, self.stepper.inbox.missing(), self.now)

    def reconfigured(self) -> None:
        """Time goes on from here at its new pace."""
        self._pace.start(self.now)

    def _begin(self) -> None:
        self._recorded = -1  # stamp up to which the recorder holds everything
        self._held.clear()
        self.publish(self.stepper.begin_run())
        self._silence.answered()
        self._pace.start(self.now)

    def _put_awaited_signals_first(self) -> None:
        """Publish first what most nodes listen to: their step goes on while the rest is being published."""
        readers = {signal: writer.publisher.get_subscription_count() for signal, writer in self.writers.items()}
        order = sorted(self.writers, key=lambda signal: (-readers[signal], arrival_place(signal)))
        self._order = [self.writers[signal] for signal in order]

    def publish(self, answer: Answer) -> None:
        """Publish the state of an instant, and the clock."""
        for writer in self._order:
            writer.write(answer.stamp, answer.frame)
        if self._clock_publisher.handle.get_subscription_count():
            self._clock_publisher.publish(stamp_alone(answer.stamp))
        self._published = time.monotonic()
        self.reports.pass_on(self.stepper.part)

    @property
    def _is_paced(self) -> bool:
        return self.realtime or self.time_parameters.real_time_factor > 0

    def _due(self) -> float:
        """Wall time at which the next instant is due."""
        factor = 1.0 if self.realtime else self.time_parameters.real_time_factor
        return self._pace.due(self.now + self.stepper.period, factor)

    def _recorder_keeps_up(self) -> bool:
        if not self.time_parameters.await_recorder:
            return True
        last = self.now if self._at_end() or self.now == 0 else self.now - RECORDER_LAG * self.stepper.period
        return self._recorded >= last

    def _at_end(self) -> bool:
        end = stamps.from_seconds(self.time_parameters.duration)
        return 0 < end < self.now + self.stepper.period

    def _has_inputs(self) -> bool:
        """Whether the next instant may come as soon as it is due."""
        if self._time.rests:
            return False
        if self.realtime:
            return self._held.complete
        return self.stepper.inbox.complete() is not None and self._recorder_keeps_up()

    def _advance_where_due(self) -> None:
        while not self.done and self._has_inputs():
            late = time.monotonic() - self._due() if self._is_paced else 0.0
            if late < 0.0:
                return
            if self._at_end():
                self._end()
                return
            self._time.took_step()
            self.publish(self._held_step() if self.realtime else self.stepper.step())
            self._silence.answered()
            if self.now == self.stepper.period:
                self._pace.start(self.now)  # the first step has waited for all nodes to come up
            if self.realtime and late > stamps.to_seconds(self.stepper.period):
                self._note_overrun()

    def _held_step(self) -> Answer:
        """One step with the newest inputs; without a torque command that is fresh enough the torque is zero."""
        age_limit = stamps.from_seconds(self.time_parameters.command_timeout)
        return self.stepper.step_with(self.now, self._held.at(self.now, age_limit))

    def _note_overrun(self) -> None:
        """Time that is lost stays lost: a burst of late steps would be no real time."""
        self._pace.start(self.now)
        self._overruns += 1
        if self._overruns == 1:
            self.reports.warn(f"realtime: the step to {stamps.to_seconds(self.now)} s came more than a period late")

    def _end(self) -> None:
        self.done = True
        self.get_logger().info(self._pace.summary(self.now, self.stepper.period))
        if self._overruns:
            self.get_logger().warning(f"{self._overruns} steps came more than a period late")
