"""The master of time: publishes the state of each instant, waits for all answers, integrates to the next instant.

It answers no message, but goes on where it may.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from functools import cached_property
from itertools import cycle, islice
from types import SimpleNamespace
from typing import Any

from rosgraph_msgs.msg import Clock

from ev_core.lockstep.inbox import Arrival
from ev_core.lockstep.stepper import Answer
from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.roles import MASTER, RECORDER_WRITES
from ev_msgs_py.contract.topics import TOPICS, Topic
from ev_msgs_py.wire import stamp_alone
from ev_nodes.master.real_time import MasterParameters
from ev_nodes.master.schedule import Schedule, serve_time
from ev_nodes.master.silence import Silence, misfits
from ev_nodes.rcl.taking import End
from ev_nodes.stepping.reports import wait_until_heard
from ev_nodes.stepping.runner_line import TIMING, Word
from ev_nodes.stepping.signal_io import NAMELESS, QUALITY, full_name
from ev_nodes.stepping.stepped_node import SteppedNode

_CLOCK_TOPIC = "/clock"
# The format of /clock; its messages hold no numbers beside the stamp.
_CLOCK = SimpleNamespace(template=stamp_alone(0), mask=b"", runs=(), code="d")
_LOOK_PERIOD = 1.0  # s of wall time between looks for other clocks and at the ends of topics
_AT_ONCE = 9  # topics, of which a look takes half a millisecond: real time goes on
_RETRY_PERIOD = 0.05  # s of wall time without an answer until the state is published once more
# It doubles up to this where that does not help: each repetition is answered by all, and publishers
# keep 256 messages, which a recorder that is held up for seconds has still to receive.
_LONGEST_RETRY = 0.4
_PATIENCE = 20.0  # s of wall time for the last states to arrive, on a machine with much other work


class MasterNode(SteppedNode):
    """Plays the plant and drives the graph through time; services pause, resume, step and reset."""

    extra_parameters = MasterParameters
    _retry_period = _RETRY_PERIOD

    def __init__(self, **node_arguments: Any) -> None:
        super().__init__(MASTER, **node_arguments)
        self._clock_topic = self.create_publisher(Clock, _CLOCK_TOPIC, QUALITY).handle
        self._silence = Silence(self)
        self._topics = cycle(TOPICS.values())
        serve_time(self, self.schedule, self._begin, self.reports)
        self.every(_RETRY_PERIOD, self.idle)
        self.every(_LOOK_PERIOD, self._name_other_clocks)
        self.every(_LOOK_PERIOD, self._name_misfits)
        self._begin()

    @cached_property
    def schedule(self) -> Schedule:
        """The present instant, and what holds time back."""
        return Schedule(self.stepper, self.realtime, self.configuration.extra)

    @property
    def now(self) -> int:
        """The present instant, in nanoseconds since the run began."""
        return self.schedule.now

    def also_reads(self, reads: tuple[type, ...]) -> tuple[type, ...]:
        """Its inputs, and the recorder's progress if the master shall wait for it."""
        return (*reads, RECORDER_WRITES) if self.configuration.extra.await_recorder else reads

    def receiver(self, topic: Topic) -> Callable[[bytes], None]:
        """Return the function that takes an input of the next step or, in real time, the newest one.

        That of the recorder's progress notes how far the recorder is.
        """
        kind = topic.signal
        read = self.reception.reader(topic)
        go_on = self._go_on
        offer = self.stepper.inbox.offer
        arrivals = self.reception.arrivals
        note = self.schedule.note_recorded
        hold = self.schedule.hold
        report_gap = self.reception.report_gap

        def take(message: bytes) -> None:
            readable = read(message)
            if readable is not None:
                arrival = offer(kind, *readable)
                if arrival is Arrival.NEW:
                    go_on()
                else:
                    arrivals[arrival] += 1
                    if arrival is Arrival.GAP:
                        report_gap(topic, readable[0])

        def take_newest(message: bytes) -> None:
            readable = read(message)
            if readable is not None:
                if kind is RECORDER_WRITES:
                    note(readable[0])
                elif not hold(kind, *readable):
                    report_gap(topic, readable[0])
            go_on()  # a step that is due waits for no pause between messages

        return take_newest if self.realtime or kind is RECORDER_WRITES else take

    def wanted(self) -> tuple[type, ...]:
        """The missing inputs, or the recorder's progress if only that is behind."""
        return super().wanted() or (() if self.schedule.recorder_keeps_up else (RECORDER_WRITES,))

    def wake_up_within(self) -> float:
        """Seconds until the next instant is due, at most the period of retries."""
        return min(self.schedule.due_within, _RETRY_PERIOD)

    def idle(self) -> None:
        """Advance if time is due, publish the state again if answers are late, and name the nodes that are silent."""
        self._go_on()
        if self.done or self.schedule.rests:
            return
        super().idle()
        if self.realtime and self.schedule.missing:
            self.report_waiting(self.now, self.schedule.missing)
        if not self.schedule.all_are_here and time.monotonic() - self._spoke >= self._retry_period:
            self._repeat()
            if self.now:  # before that nodes are still coming up
                self._retry_period = min(2.0 * self._retry_period, _LONGEST_RETRY)
            self.health.late_answers += 1
            self._silence.name_after(
                self.configuration.extra.answer_timeout, self.schedule.missing, self.now
            )

    def why_it_waits(self, missing: tuple[type, ...]) -> list[str]:
        """List what is wrong with the graph, and with messages that have arrived."""
        return [*self._silence.reasons(missing), *super().why_it_waits(missing)]

    def free_until(self) -> int:
        """Stamp of the last instant at which time may go on as soon as all inputs are there."""
        return self.schedule.free_until

    def ends(self) -> list[End]:
        """The publishers of the state, and that of the clock."""
        return [*super().ends(), End(self._clock_topic.pointer, _CLOCK)]

    def publish(self, answer: Answer) -> None:
        """Publish the state, and then its stamp as /clock."""
        super().publish(answer)
        if self._clock_topic.get_subscription_count():
            self._clock_topic.publish_raw(stamp_alone(answer.stamp))
        self._spoke = time.monotonic()

    def _name_other_clocks(self) -> None:
        """Report other masters on the clock: time jumps back and forth for every node that follows it."""
        clock, own = self.resolve_topic_name(_CLOCK_TOPIC), self.get_fully_qualified_name()
        ends = self.get_publishers_info_by_topic(clock)
        names = {full_name(end) for end in ends}
        # A former master of the own name, which has ended, may still be listed.
        for other in sorted(name for name in names - {own} if NAMELESS not in name):
            rule = f"-r {_CLOCK_TOPIC}:={_CLOCK_TOPIC.strip('/')}"
            self.reports.note(
                clock, f"{other} publishes {clock} as well; {rule} lets each have its own"
            )

    def _name_misfits(self) -> None:
        """Report what does not fit on the next topics."""
        for topic in islice(self._topics, _AT_ONCE):
            for each in misfits(self, topic):
                self.reports.note(each.line, each.line)

    def _repeat(self) -> None:
        """Publish once more, first what most nodes receive: their step goes on while the rest is being published."""
        by_readers = sorted(
            self.writers.items(), key=lambda each: -each[1].publisher.get_subscription_count()
        )
        self.writers = dict(by_readers)
        if self.stepper.answer is not None:
            self.publish(self.stepper.answer)

    def went_on(self, spoke: float) -> None:
        """Note that all nodes have answered."""
        super().went_on(spoke)
        self._retry_period = _RETRY_PERIOD
        self._spoke = spoke
        self._silence.answered()

    def reconfigured(self) -> None:
        """Let time go on from here at its new pace."""
        self.schedule.follow(self.configuration.extra)

    def _begin(self) -> None:
        self._stepped(self.stepper.begin_run())
        self.schedule.begin()

    def _stepped(self, answer: Answer) -> None:
        self.schedule.took_step()
        self._retry_period = _RETRY_PERIOD
        self.publish(answer)
        self._silence.answered()

    def _wait_for_the_recorder(self) -> None:
        """Wait until the recorder has every state: messages of a process that ends too soon are lost.

        Real time has not waited for it so far. Where no recorder is followed, any subscriber of the
        state may be one.
        """
        reader = self.readers.get(RECORDER_WRITES)

        def is_behind() -> bool:
            while reader is not None and (message := reader.take()) is not None:
                reader.receive(message)
            return self.schedule.recorder_is_behind

        given_up = time.monotonic() + _PATIENCE
        for writer in self.writers.values():
            wait_until_heard(writer.publisher, given_up, is_behind)

    def _go_on(self) -> None:
        """Take all steps that may be taken now."""
        schedule, realtime = self.schedule, self.realtime
        while not self.done and schedule.has_inputs:
            late = schedule.lateness
            if late < 0.0:
                return
            if schedule.at_end:
                self._end()
                return
            answer = schedule.held_step() if realtime else self.stepper.step()
            assert answer is not None, "the schedule lets time go on only with all inputs"
            if schedule.now == self.stepper.period:
                schedule.pace_from_here()  # the first step has waited for all nodes to come up
            self._stepped(answer)
            if realtime:
                schedule.timing.stepped(late)
                if late > stamps.to_seconds(self.stepper.period):
                    self._note_overrun()

    def _note_overrun(self) -> None:
        """Give up the time that is lost: a burst of steps to catch up would be no real time."""
        self.schedule.lose_what_is_late()
        self.schedule.timing.overruns += 1
        if self.schedule.timing.overruns == 1:
            at = stamps.to_seconds(self.now)
            self.reports.warn(f"realtime: the step to {at} s came more than a period late")

    def _end(self) -> None:
        self.done = True
        self.reports.pass_on(self.stepper.part)
        self.get_logger().info(self.schedule.summary)
        if self.realtime:
            timing = self.schedule.timing.as_json()
            self.reports.tell(TIMING, self.schedule.summary, {TIMING: json.dumps(timing)})
            self.reports.runner.tell(Word(TIMING, self.schedule.summary, values=timing))
            self.reports.wait_until_heard()
            self._wait_for_the_recorder()
