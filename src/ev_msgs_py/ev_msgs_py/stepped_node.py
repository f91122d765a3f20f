"""The ROS node around a stepper: parameters, subscriptions, publishers and diagnostics of every role."""

from __future__ import annotations

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
from ev_msgs_py.configuration import Configuration, configure
from ev_msgs_py.inbox import Arrival
from ev_msgs_py.message_classes import message_class
from ev_msgs_py.parameters import ParameterError
from ev_msgs_py.stepper import Answer, Stepper, arrival_place
from ev_msgs_py.topics import QUEUE_DEPTH, TOPICS, Topic

QUALITY = QoSProfile(depth=QUEUE_DEPTH)  # reliable, volatile, keep last


class SignalWriter:
    """Publishes one signal, reusing one message object."""

    def __init__(self, node: Node, topic: Topic) -> None:
        self._codec = topic.codec
        self._message = topic.codec.prepare(message_class(topic.codec.message_type)())
        self._header = getattr(self._message, "header", self._message)
        self._header.frame_id = topic.frame
        self.publisher: Publisher = node.create_publisher(type(self._message), topic.name, QUALITY)

    def write(self, stamp: int, signal: Any) -> None:
        """Publish a signal; SignalError, and nothing is published, if a number is not finite."""
        self._codec.encode(signal, self._message)
        stamps.write(self._header.stamp, stamp)
        self.publisher.publish(self._message)


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
        self.configuration = configure(role, ros_parameters.overrides(self), self.extra_parameters)
        ros_parameters.declare(self, self.configuration.entries())
        self.stepper = Stepper(self.configuration.method, self._create, self.configuration.period, self.realtime)
        self.add_on_set_parameters_callback(self._on_set_parameters)
        self._diagnostics = self.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self.writers = {signal: SignalWriter(self, TOPICS[signal]) for signal in self.configuration.method.writes}
        self.signal_subscriptions = {signal: self._subscribe(signal) for signal in self.also_reads(self.stepper.reads)}
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

    def _subscribe(self, signal: type) -> Subscription:
        topic = TOPICS[signal]

        def receive(message: Any) -> None:
            self.receive(topic, message)

        return self.create_subscription(message_class(topic.codec.message_type), topic.name, receive, QUALITY)

    def poll(self) -> bool:
        """Take every message that has arrived and step where inputs are complete; False if there was none."""
        progressed = False
        for subscription in self.signal_subscriptions.values():
            handle = subscription.handle
            while (taken := handle.take_message(subscription.msg_type, False)) is not None:
                progressed = True
                subscription.callback(taken[0])
        return progressed

    def awaits(self) -> list[Subscription]:
        """The subscriptions worth waking up for: within a step only the input that arrives last."""
        missing = self.stepper.inbox.missing()
        if self.stepper.inbox.last is None or not missing:
            return list(self.signal_subscriptions.values())
        last = max(missing, key=arrival_place)
        return [self.signal_subscriptions[last]]

    def wake_up_within(self) -> float:
        """Seconds after which the node wants to be polled though no message has come."""
        return 0.02

    def idle(self) -> None:
        """Called when there is nothing to take."""

    def receive(self, topic: Topic, message: Any) -> None:
        """Judge a message, step if that completes the inputs, answer."""
        signal = self.decoded(topic, message)
        if signal is None:
            return
        stamp = stamps.read(getattr(message, "header", message).stamp)
        fresh = self.stepper.is_fresh
        arrival = self.stepper.offer(topic.signal, stamp, signal)
        if fresh and stamp > 0:
            self.warn(f"joined at {stamps.to_seconds(stamp)} s with a fresh state: the run is not reproducible")
        self.arrived(topic, stamp, arrival)

    def decoded(self, topic: Topic, message: Any) -> Any | None:
        """The signal in a message; None, and a report, if the message is refused."""
        try:
            return topic.codec.decode(message)
        except MessageError as error:
            stamp = stamps.read(getattr(message, "header", message).stamp)
            self.warn(f"{topic.name} at {stamps.to_seconds(stamp)} s ignored: {error}")
            return None

    def arrived(self, topic: Topic, stamp: int, arrival: Arrival) -> None:
        """Answer a message, or report it if it cannot belong to this run."""
        if arrival is Arrival.GAP and topic not in self._gaps:
            self._gaps.add(topic)
            due = stamps.to_seconds(self.stepper.inbox.last + self.stepper.period)
            self.warn(f"{topic.name} at {stamps.to_seconds(stamp)} s ignored (reported once): {due} s is due")
        for answer in self.stepper.answers_to(topic.signal, stamp, arrival):
            self.publish(answer)

    def publish(self, answer: Answer) -> None:
        """Publish an answer."""
        for signal in answer.signals:
            self.writers[type(signal)].write(answer.stamp, signal)

    def warn(self, text: str) -> None:
        """Say something once in the log and in /diagnostics."""
        self.get_logger().warning(text)
        status = DiagnosticStatus(level=DiagnosticStatus.WARN, name=self.get_fully_qualified_name(), message=text)
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
        except (ParameterError, ValueError) as error:
            return SetParametersResult(successful=False, reason=str(error))
        successor.state = self.stepper.object.state
        self.configuration, self.stepper.object = configuration, successor
        self.warn(f"parameters changed to {given}: the run is not reproducible")
        return SetParametersResult(successful=True)

