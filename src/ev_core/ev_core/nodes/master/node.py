"""The master of time: publishes the state of each instant, waits for all answers, integrates to the next instant.

It answers no message, but goes on where it may.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import cached_property
from typing import Any

from rclpy.clock import Clock as RosClock
from rclpy.clock_type import ClockType

from ev_core.lockstep.inbox import Arrival, Inbox
from ev_core.lockstep.stepper import Answer
from ev_core.node_loop.message_memory import End
from ev_core.nodes.master.advance import Advance, Silence, TimeServices
from ev_core.nodes.master.real_time import MasterParameters
from ev_core.nodes.master.schedule import Schedule
from ev_core.nodes.reception import Reception
from ev_core.nodes.runner_line import TIMING, Word
from ev_core.nodes.signal_io import StatePublisher
from ev_core.nodes.stepped_node import SteppedNode
from ev_msgs_py.contract.roles import MASTER, RECORDER_WRITES
from ev_msgs_py.contract.topics import Topic


class MasterInputs:
    """Makes the functions that take messages; `go_on` is called when time may advance."""

    def __init__(self, reception: Reception, inbox: Inbox, schedule: Schedule, go_on: Callable[[], None]) -> None:
        self._reception, self._inbox, self._schedule, self._go_on = reception, inbox, schedule, go_on

    def receiver(self, topic: Topic) -> Callable[[bytes], None]:
        """Takes an input of the next step or, in real time, the newest; or notes how far the recorder is."""
        if topic.signal is RECORDER_WRITES:
            return self._of_the_recorder(topic)
        return self._held(topic) if self._schedule.realtime else self._of_a_step(topic)

    def _of_a_step(self, topic: Topic) -> Callable[[bytes], None]:
        kind, read, offer, go_on = topic.signal, self._reception.reader(topic), self._inbox.offer, self._go_on
        arrivals = self._reception.arrivals

        def take(message: bytes) -> None:
            readable = read(message)
            if readable is not None:
                arrival = offer(kind, *readable)
                if arrival is Arrival.NEW:
                    go_on()
                else:
                    arrivals[arrival] += 1

        return take

    def _held(self, topic: Topic) -> Callable[[bytes], None]:
        read = self._reception.reader(topic)

        def hold(message: bytes) -> None:
            readable = read(message)
            if readable is not None:
                self._schedule.hold(topic.signal, *readable)
            self._go_on()  # a step that is due waits for no pause between messages

        return hold

    def _of_the_recorder(self, topic: Topic) -> Callable[[bytes], None]:
        read = self._reception.reader(topic)

        def note(message: bytes) -> None:
            readable = read(message)
            if readable is not None:
                self._schedule.note_recorded(readable[0])
                self._go_on()

        return note


_RETRY_PERIOD = 0.05  # s of wall time without an answer after which the state is published once more
# It doubles up to this where that does not help: each repetition is answered by all, and publishers keep 256 messages,
# which a recorder that is held up for seconds has still to receive.
_LONGEST_RETRY = 0.4


class MasterNode(SteppedNode):
    """Plays the plant and drives the graph through time; services pause, resume, step and reset."""

    extra_parameters = MasterParameters

    def __init__(self, **node_arguments: Any) -> None:
        super().__init__(MASTER, **node_arguments)
        self._state = StatePublisher(self, self.writers.values())
        self._retry_period = _RETRY_PERIOD
        self._silence = Silence(self)
        self._advance = Advance(self.stepper, self.schedule, self._stepped, self.reports.warn)
        schedule = self.schedule
        self._granted = TimeServices(
            self, lambda: self.now, self._begin, schedule.rest_here, schedule.go_on_here, self.reports
        )
        self.schedule.rests = self._granted.rests
        # For rclpy's own executors; `spinning.spin` calls idle() by itself. The clock is the wall's, not /clock.
        self.create_timer(_RETRY_PERIOD, self.idle, clock=RosClock(clock_type=ClockType.STEADY_TIME))
        self._begin()

    @cached_property
    def schedule(self) -> Schedule:
        """Where time is, and what holds it back."""
        return Schedule(self.stepper, self.realtime, self.configuration.extra)

    @property
    def now(self) -> int:
        """The present instant, in nanoseconds since the run began."""
        return self.schedule.now

    def also_reads(self, reads: tuple[type, ...]) -> tuple[type, ...]:
        """Besides its inputs the master follows the recorder, if it shall wait for it."""
        return (*reads, RECORDER_WRITES) if self.configuration.extra.await_recorder else reads

    def receiver(self, topic: Topic) -> Callable[[bytes], None]:
        """What takes the serialized messages of a topic."""
        return MasterInputs(self.reception, self.stepper.inbox, self.schedule, self._go_on).receiver(topic)

    def wanted(self) -> tuple[type, ...]:
        """The missing inputs, or the recorder's progress if only that is behind."""
        return super().wanted() or (() if self.schedule.recorder_keeps_up else (RECORDER_WRITES,))

    def wake_up_within(self) -> float:
        """Seconds until the next instant is due, at most the period of retries."""
        return min(self.schedule.due_within, _RETRY_PERIOD)

    def idle(self) -> None:
        """Advance if time is due, publish the state again if answers are late, and name the nodes that are silent."""
        self._go_on()
        if self.done or self._granted.rests():
            return
        super().idle()
        if not self.schedule.all_are_here and self._state.silent_for >= self._retry_period:
            self._state.repeat(self.stepper.answer)
            if self.now:  # before that nodes are still coming up
                self._retry_period = min(2.0 * self._retry_period, _LONGEST_RETRY)
            self.health.late_answers += 1
            self._silence.name_after(self.configuration.extra.answer_timeout, self.schedule.missing, self.now)

    def free_until(self) -> int:
        """Stamp of the last instant at which time may go on as soon as all inputs are there."""
        return -1 if self._granted.paused else self.schedule.free_until

    def ends(self) -> list[End]:
        """The publishers of the state, and that of the clock."""
        return self._state.ends()

    def went_on(self, spoke: float) -> None:
        """Nobody is silent."""
        super().went_on(spoke)
        self._retry_period = _RETRY_PERIOD
        self._state.spoke = spoke
        self._silence.answered()

    def reconfigured(self) -> None:
        """Time goes on from here at its new pace."""
        self.schedule.follow(self.configuration.extra)

    def _begin(self) -> None:
        self._stepped(self.stepper.begin_run())
        self.schedule.begin()

    def _stepped(self, answer: Answer) -> None:
        self._granted.took_step()
        self._retry_period = _RETRY_PERIOD
        self._state.publish(answer)
        self.reports.pass_on_now_and_then(self.stepper.part)
        self._silence.answered()

    def _wait_for_the_recorder(self) -> None:
        """Real time has not waited for it, and the last message of a process is lost if it ends too soon.

        Where none is followed, any subscriber of the state may be one.
        """
        reader = self.readers.get(RECORDER_WRITES)

        def is_behind() -> bool:
            while reader is not None and (message := reader.take()) is not None:
                reader.receive(message)
            return self.schedule.recorder_is_behind

        self._state.wait_until_heard(is_behind)

    def _go_on(self) -> None:
        self._advance.where_due()
        if self._advance.ended and not self.done:
            self.done = True
            self.reports.pass_on(self.stepper.part)
            self.get_logger().info(self._advance.summary)
            if self.realtime:
                timing = self.schedule.timing.as_json()
                self.reports.tell(TIMING, self._advance.summary, {TIMING: json.dumps(timing)})
                self.reports.runner.tell(Word(TIMING, self._advance.summary, values=timing))
                self.reports.wait_until_heard()
                self._wait_for_the_recorder()
