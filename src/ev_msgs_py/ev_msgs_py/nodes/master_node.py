"""The master of time: publishes the state of each instant, waits for all answers, integrates to the next instant."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from rclpy.clock import Clock as RosClock
from rclpy.clock import ClockType
from rclpy.subscription import Subscription
from rosgraph_msgs.msg import Clock

from ev_msgs_py.contract.roles import MASTER, RECORDER_WRITES
from ev_msgs_py.contract.topics import Topic
from ev_msgs_py.lockstep.inbox import Arrival
from ev_msgs_py.lockstep.stepper import Answer, arrival_place
from ev_msgs_py.nodes.advance import Advance
from ev_msgs_py.nodes.master_parameters import MasterParameters
from ev_msgs_py.nodes.schedule import Schedule
from ev_msgs_py.nodes.signal_io import QUALITY
from ev_msgs_py.nodes.silence import Silence
from ev_msgs_py.nodes.stepped_node import SteppedNode
from ev_msgs_py.nodes.time_services import TimeServices
from ev_msgs_py.wire.message_format import stamp_alone, stamp_of

_RETRY_PERIOD = 0.05  # s of wall time without an answer after which the state is published once more


class MasterNode(SteppedNode):
    """Plays the plant and drives the graph through time; services pause, resume, step and reset."""

    extra_parameters = MasterParameters

    def __init__(self, **node_arguments: Any) -> None:
        super().__init__(MASTER, **node_arguments)
        self._clock_publisher = self.create_publisher(Clock, "/clock", QUALITY)
        self.schedule = Schedule(self.stepper, self.realtime, lambda: self.configuration.extra)
        self._silence = Silence(self)
        self._granted = TimeServices(self, lambda: self.now, self._begin, self.schedule.pace_from_here)
        self.schedule.rests = self._granted.rests
        self._order = list(self.writers.values())  # in which the signals of an answer are published
        self._advance = Advance(self.stepper, self.schedule, self._stepped, self.reports.warn)
        # For rclpy's own executors; `spinning.spin` calls idle() by itself. The clock is the wall's, not /clock.
        self.create_timer(_RETRY_PERIOD, self.idle, clock=RosClock(clock_type=ClockType.STEADY_TIME))
        self._begin()

    @property
    def now(self) -> int:
        """Stamp of the present instant, in nanoseconds."""
        return self.schedule.now

    def also_reads(self, reads: tuple[type, ...]) -> tuple[type, ...]:
        """Besides its inputs the master follows the recorder, if it shall wait for it."""
        return (*reads, RECORDER_WRITES) if self.configuration.extra.await_recorder else reads

    def wanted(self) -> tuple[type, ...]:
        """The missing inputs, or the recorder's progress if only that is behind."""
        missing = super().wanted()
        return missing if missing or self.schedule.recorder_keeps_up else (RECORDER_WRITES,)

    def awaits(self) -> Subscription:
        """The input that arrives last, also while the next step is only waiting for its time."""
        wanted = self.wanted() or self.stepper.reads
        return self.readers[wanted[0] if len(wanted) == 1 else max(wanted, key=arrival_place)].subscription

    def wake_up_within(self) -> float:
        """Seconds until the next instant is due if nothing else holds it back, at most the period of retries."""
        late = self.schedule.lateness
        return min(-late, _RETRY_PERIOD) if late < 0.0 and self.schedule.has_inputs else _RETRY_PERIOD

    def receiver(self, topic: Topic) -> Callable[[bytes], None]:
        """Takes an input, or notes how far the recorder is; an input that is known needs no answer from here."""
        keep = self.reception.keeper(topic)

        def take(message: bytes) -> None:
            kept = keep(message)
            if kept is not None and kept[1] is Arrival.NEW:
                self._advance_where_due()

        def note(message: bytes) -> None:
            readable = self.reception.readable(topic, message)
            if readable is not None:
                self._note(topic, readable)

        return note if topic.signal is RECORDER_WRITES or self.realtime else take

    def _note(self, topic: Topic, message: bytes) -> None:
        if topic.signal is RECORDER_WRITES:
            self.schedule.note_recorded(stamp_of(message))
            self._advance_where_due()
        elif self.schedule.held.take(topic, message):
            self.schedule.pace_from_here()  # realtime begins when the last input has come

    def idle(self) -> None:
        """Advance if time is due, publish the state again if answers are late, and name the nodes that are silent."""
        self._advance_where_due()
        under_way = self.realtime and self.schedule.held.complete
        if self.done or self._granted.rests() or under_way or time.monotonic() - self._published < _RETRY_PERIOD:
            return
        if self.stepper.inbox.complete() is None or not self.schedule.recorder_keeps_up:
            # What most nodes listen to goes first: their step goes on while the rest is being published.
            self._order.sort(key=lambda writer: -writer.publisher.get_subscription_count())
            self.publish(self.stepper.answer)
            missing, timeout = self.stepper.inbox.missing(), self.configuration.extra.answer_timeout
            self._silence.name_after(timeout, missing, self.now)

    def reconfigured(self) -> None:
        """Time goes on from here at its new pace."""
        self.schedule.pace_from_here()

    def publish(self, answer: Answer) -> None:
        """Publish the state of an instant, and the clock."""
        for writer in self._order:
            writer.write(answer.stamp, answer.frame)
        if self._clock_publisher.handle.get_subscription_count():
            self._clock_publisher.publish(stamp_alone(answer.stamp))
        self._published = time.monotonic()
        self.reports.pass_on_now_and_then(self.stepper.part)

    def _begin(self) -> None:
        self.publish(self.stepper.begin_run())
        self._silence.answered()
        self.schedule.begin()

    def _stepped(self, answer: Answer) -> None:
        self._granted.took_step()
        self.publish(answer)
        self._silence.answered()

    def _advance_where_due(self) -> None:
        self._advance.where_due()
        if self._advance.ended and not self.done:
            self.done = True
            self.reports.pass_on(self.stepper.part)
            self.get_logger().info(self.schedule.summary)
            if self._advance.overruns:
                self.get_logger().warning(f"{self._advance.overruns} steps came more than a period late")
