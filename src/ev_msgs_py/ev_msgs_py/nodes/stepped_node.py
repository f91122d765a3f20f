"""The common part of all nodes of the graph: parameters, topics, and a part that is stepped by stamps."""

from __future__ import annotations

from typing import Any

from rclpy.node import Node
from rclpy.subscription import Subscription

from ev_msgs_py import stamps
from ev_msgs_py.configuration import Configuration, configure
from ev_msgs_py.lockstep.inbox import Arrival
from ev_msgs_py.lockstep.part import Part
from ev_msgs_py.lockstep.parts import hand_over, part_of
from ev_msgs_py.lockstep.stepper import Answer, Stepper, arrival_place
from ev_msgs_py.nodes import ros_parameters
from ev_msgs_py.nodes.live_parameters import LiveParameters
from ev_msgs_py.nodes.reports import Reports
from ev_msgs_py.nodes.signal_io import SignalReader, SignalWriter
from ev_msgs_py.topics import TOPICS, Topic
from ev_msgs_py.wire.layout import MessageError
from ev_msgs_py.wire.message_format import format_of, stamp_of

_LOOK_PERIOD = 0.02  # s of wall time between looks for what nobody waits for: repetitions of messages


class SteppedNode(Node):
    """Plays a role: steps its part once per stamp and answers with the same stamp.

    ParameterError or ValueError if the parameters that it is given are refused; the node does not exist then.
    """

    extra_parameters: type | None = None

    def __init__(self, role: str, **node_arguments: Any) -> None:
        super().__init__(role, automatically_declare_parameters_from_overrides=True, **node_arguments)
        self.role = role
        self.done = False
        self._gaps: set[Topic] = set()
        self._joined_late = False
        self._before_reset = -1  # stamp up to which late messages may still be of the run before a reset
        configuration = configure(role, ros_parameters.overrides(self), self.extra_parameters)
        self.reports = Reports(self, role)
        self.live = LiveParameters(self, configuration, self._new_part, self._take_over)
        self.stepper = Stepper(
            configuration.method, lambda: self._new_part(self.configuration), configuration.period, self.realtime
        )
        self.writers = {signal: SignalWriter(self, TOPICS[signal]) for signal in configuration.method.writes}
        self.readers = {
            signal: SignalReader(self, TOPICS[signal], self.receive) for signal in self.also_reads(self.stepper.reads)
        }
        if configuration.unused:
            names = ", ".join(configuration.unused)
            self.get_logger().info(f"method {configuration.method.name} does not use: {names}")

    @property
    def configuration(self) -> Configuration:
        """What the parameters say now."""
        return self.live.configuration

    @property
    def realtime(self) -> bool:
        """Whether the wall clock drives the graph, so that steps may be skipped."""
        return self.configuration.common.mode == "realtime"

    def also_reads(self, reads: tuple[type, ...]) -> tuple[type, ...]:
        """The signals to subscribe to, by default those that the method reads."""
        return reads

    def _new_part(self, configuration: Configuration) -> Part:
        return part_of(configuration, compiled=False)

    def _take_over(self, before: Configuration, given: dict[str, Any], part: Part) -> None:
        """Go on with other parameters; the state lasts."""
        after = self.configuration
        if (after.parameters, after.sensors) != (before.parameters, before.sensors):
            hand_over(self.stepper.part, part)
            self.stepper.part = part
            self.reports.warn(f"parameters changed to {given}: the run is not reproducible")
        self.reconfigured()

    def reconfigured(self) -> None:
        """Called when new parameter values are taken over."""

    def poll(self) -> bool:
        """Take what the next step waits for and step where that completes the inputs; False if nothing was there."""
        progressed = False
        for signal in self.wanted():
            progressed |= self.readers[signal].take()
        return progressed

    def sweep(self) -> None:
        """Take everything: what nobody waits for are repetitions, and they tell that somebody misses an answer."""
        for reader in self.readers.values():
            while reader.take():
                pass

    def wanted(self) -> tuple[type, ...]:
        """The signals that the next step waits for."""
        return self.stepper.inbox.missing()

    def awaits(self) -> Subscription:
        """The subscription to wake up for: of the inputs that are missing the one that arrives last."""
        return self.readers[max(self.wanted(), key=arrival_place)].subscription

    def wake_up_within(self) -> float:
        """Seconds after which the node wants to be polled though no message has come."""
        return _LOOK_PERIOD

    def idle(self) -> None:
        """Called when there is nothing to take."""

    def close(self) -> None:
        """Called at the end of the process."""

    def receive(self, topic: Topic, message: bytes) -> None:
        """Judge a message, step if that completes the inputs, answer."""
        message = self.readable(topic, message)
        if message is None:
            return
        stamp, stepper = stamp_of(message), self.stepper
        fresh, last = stepper.is_fresh, stepper.inbox.last
        arrival = stepper.offer(topic.signal, stamp)
        if arrival is Arrival.NEW or arrival is Arrival.RESTART:
            format_of(topic.signal).unpack(message, stepper.inbox.frame_at(stamp))
            if arrival is Arrival.NEW and stepper.lacks_inputs:
                return  # most messages end here
        if arrival is Arrival.RESTART:
            self._before_reset = last + 2 * stepper.period
        if fresh and stamp > 0 and not self._joined_late:
            self._joined_late = True
            self.reports.warn(f"joined at {stamps.to_seconds(stamp)} s with a fresh state: the run is not reproducible")
        self.arrived(topic, stamp, arrival)

    def readable(self, topic: Topic, message: bytes) -> bytes | None:
        """The message in our own layout; None, and a report, if it is refused."""
        try:
            return format_of(topic.signal).canonical(message)
        except MessageError as error:
            self.reports.warn(f"{topic.name}{_when(message)} ignored: {error}")
            return None

    def arrived(self, topic: Topic, stamp: int, arrival: Arrival) -> None:
        """Answer a message, or report it if it cannot belong to this run."""
        if arrival is Arrival.GAP and topic not in self._gaps and stamp > self._before_reset:
            self._gaps.add(topic)
            due = stamps.to_seconds(self.stepper.inbox.last + self.stepper.period)
            self.reports.warn(
                f"{topic.name} at {stamps.to_seconds(stamp)} s ignored (reported once): {due} s is due"
            )
        for answer in self.stepper.answers_to(topic.signal, stamp, arrival):
            self.publish(answer)

    def publish(self, answer: Answer) -> None:
        """Publish an answer."""
        for writer in self.writers.values():
            writer.write(answer.stamp, answer.frame)
        self.reports.pass_on(self.stepper.part)


def _when(message: bytes) -> str:
    """The instant of a message in words, as far as it can be read."""
    try:
        return f" at {stamps.to_seconds(stamp_of(message))} s"
    except MessageError:
        return ""
