"""The ROS node around a stepper: parameters, subscriptions, publishers and diagnostics of every role."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile
from rclpy.subscription import Subscription

from ev_msgs_py import ros_parameters, stamps
from ev_msgs_py.codec import MessageError
from ev_msgs_py.configuration import configure
from ev_msgs_py.inbox import Arrival
from ev_msgs_py.notes import Notes
from ev_msgs_py.stepper import Answer, Stepper, arrival_place
from ev_msgs_py.topics import QUEUE_DEPTH, TOPICS, Topic
from ev_msgs_py.wire_format import stamp_of, wire_format

QUALITY = QoSProfile(depth=QUEUE_DEPTH)  # reliable, volatile, keep last


class SignalWriter:
    """Publishes one signal."""

    def __init__(self, node: Node, topic: Topic) -> None:
        self._wire = wire_format(topic.signal)
        self.publisher: Publisher = node.create_publisher(self._wire.message_class, topic.name, QUALITY)
        self._publish = self.publisher.handle.publish_raw

    def write(self, stamp: int, signal: Any) -> None:
        """Publish a signal; SignalError, and nothing is published, if a number is not finite."""
        self._publish(self._wire.pack(stamp, signal))


class SignalReader:
    """Receives one signal: gives each serialized message to `receive`, from an executor or where `take` finds one."""

    def __init__(self, node: Node, topic: Topic, receive: Callable[[Topic, bytes], None]) -> None:
        message_class = wire_format(topic.signal).message_class
        self._receive = partial(receive, topic)
        self.subscription = node.create_subscription(message_class, topic.name, self._receive, QUALITY, raw=True)
        self._take = partial(self.subscription.handle.take_message, message_class, True)

    def take(self) -> bool:
        """Take a message if there is one."""
        taken = self._take()
        if taken is None:
            return False
        self._receive(taken[0])
        return True


class SteppedNode(Node):
    """Plays a role: steps its object once per stamp and answers with the same stamp.

    ParameterError or ValueError if the parameters that it is given are refused; the node does not exist then.
    """

    extra_parameters: type | None = None

    def __init__(self, role: str, **node_arguments: Any) -> None:
        super().__init__(role, automatically_declare_parameters_from_overrides=True, **node_arguments)
        self.role = role
        self.done = False
        self._gaps: set[Topic] = set()
        self._notes = Notes()
        self._joined_late = False
        self._before_reset = -1  # stamp up to which late messages may still be of the run before a reset
        self.configuration = configure(role, ros_parameters.overrides(self), self.extra_parameters)
        ros_parameters.declare(self, self.configuration.entries())
        self.stepper = Stepper(self.configuration.method, self._create, self.configuration.period, self.realtime)
        self.add_on_set_parameters_callback(self._on_set_parameters)
        self._diagnostics = self.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self.writers = {signal: SignalWriter(self, TOPICS[signal]) for signal in self.configuration.method.writes}
        self.readers = {
            signal: SignalReader(self, TOPICS[signal], self.receive) for signal in self.also_reads(self.stepper.reads)
        }
        if self.configuration.unused:
            names = ", ".join(self.configuration.unused)
            self.get_logger().info(f"method {self.configuration.method.name} does not use: {names}")

    @property
    def realtime(self) -> bool:
        """Whether the wall clock drives the graph, so that steps may be skipped."""
        return self.configuration.common.mode == "realtime"

    def also_reads(self, reads: tuple[type, ...]) -> tuple[type, ...]:
        """The signals to subscribe to, by default those that the method reads."""
        return reads

    def _create(self) -> Any:
        return self.configuration.create()

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
        return 0.02

    def idle(self) -> None:
        """Called when there is nothing to take."""

    def close(self) -> None:
        """Called at the end of the process."""

    def receive(self, topic: Topic, message: bytes) -> None:
        """Judge a message, step if that completes the inputs, answer."""
        received = self.unpacked(topic, message)
        if received is None:
            return
        stamp, signal = received
        fresh, last = self.stepper.is_fresh, self.stepper.inbox.last
        arrival = self.stepper.offer(topic.signal, stamp, signal)
        if arrival is Arrival.NEW and self.stepper.lacks_inputs:
            return  # most messages end here
        if arrival is Arrival.RESTART:
            self._before_reset = last + 2 * self.stepper.period
        if fresh and stamp > 0 and not self._joined_late:
            self._joined_late = True
            self.warn(f"joined at {stamps.to_seconds(stamp)} s with a fresh state: the run is not reproducible")
        self.arrived(topic, stamp, arrival)

    def unpacked(self, topic: Topic, message: bytes) -> tuple[int, Any] | None:
        """Stamp and signal of a message; None, and a report, if the message is refused."""
        try:
            return wire_format(topic.signal).unpack(message)
        except MessageError as error:
            self.warn(f"{topic.name} at {stamps.to_seconds(stamp_of(message))} s ignored: {error}")
            return None

    def arrived(self, topic: Topic, stamp: int, arrival: Arrival) -> None:
        """Answer a message, or report it if it cannot belong to this run."""
        if arrival is Arrival.GAP and topic not in self._gaps and stamp > self._before_reset:
            self._gaps.add(topic)
            due = stamps.to_seconds(self.stepper.inbox.last + self.stepper.period)
            self.warn(f"{topic.name} at {stamps.to_seconds(stamp)} s ignored (reported once): {due} s is due")
        for answer in self.stepper.answers_to(topic.signal, stamp, arrival):
            self.publish(answer)

    def publish(self, answer: Answer) -> None:
        """Publish an answer."""
        for signal in answer.signals:
            self.writers[type(signal)].write(answer.stamp, signal)
        self.pass_notes_on()

    def pass_notes_on(self) -> None:
        """Say what the object of the method has to say, in the log and, as OK, in /diagnostics."""
        for text in self._notes.new(self.stepper.object):
            self.get_logger().info(text)
            self._diagnose(DiagnosticStatus.OK, text)

    def warn(self, text: str) -> None:
        """Say something once in the log and in /diagnostics: the run may not be reproducible."""
        self.get_logger().warning(text)
        self._diagnose(DiagnosticStatus.WARN, text)

    def _diagnose(self, level: bytes, text: str) -> None:
        status = DiagnosticStatus(level=level, name=self.get_fully_qualified_name(), message=text)
        status.values = [KeyValue(key="role", value=self.role)]
        report = DiagnosticArray(status=[status])
        report.header.stamp = self.get_clock().now().to_msg()
        self._diagnostics.publish(report)

    def _on_set_parameters(self, changes: list[Parameter]) -> SetParametersResult:
        """Take new values over between two steps, all of them or none; the state lasts."""
        given = {change.name: change.value for change in changes if not ros_parameters.is_ros_own(change.name)}
        if not given:
            return SetParametersResult(successful=True)
        try:
            configuration = self.configuration.changed(given)
            successor = configuration.create()
        except ValueError as error:
            return SetParametersResult(successful=False, reason=str(error))
        before = self.configuration
        if (configuration.parameters, configuration.sensors) != (before.parameters, before.sensors):
            successor.state = self.stepper.object.state
            self.stepper.object = successor
            self.warn(f"parameters changed to {given}: the run is not reproducible")
        self.configuration = configuration
        self.reconfigured()
        return SetParametersResult(successful=True)

    def reconfigured(self) -> None:
        """Called when new parameter values are taken over."""

