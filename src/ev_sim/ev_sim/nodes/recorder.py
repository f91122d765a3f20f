"""The recorder node: a bag of everything while the run lasts, signals.npz at its end."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from rclpy.clock import Clock as RosClock
from rclpy.clock import ClockType
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.subscription import Subscription
from rosgraph_msgs.msg import Clock

from ev_msgs_py import stamps
from ev_msgs_py.contract.frame import Frame
from ev_msgs_py.nodes import ros_parameters
from ev_msgs_py.nodes.run_role import run_node
from ev_msgs_py.nodes.signal_io import QUALITY, SignalWriter
from ev_msgs_py.parameters import ParameterError, build, entries
from ev_msgs_py.roles import MASTER, RECORDER_WRITES, ROLES
from ev_msgs_py.topics import TOPICS, Topic
from ev_msgs_py.wire.message_classes import message_class
from ev_msgs_py.wire.message_format import stamp_of
from ev_sim.recording.recorder_parameters import RecorderParameters
from ev_sim.recording.recording import save
from ev_sim.recording.run_recorder import RunRecorder

_NOTHING = Frame()  # the progress is nothing but its stamp
_POLL_PERIOD = 0.01  # s; several steps are taken in one go, which costs less than waking up for each message


class RecorderNode(Node):
    """Records all topics of the contract and tells the master of time how far it is."""

    _wrote = True  # until there is something to write

    def __init__(self, **node_arguments: Any) -> None:
        super().__init__("recorder", automatically_declare_parameters_from_overrides=True, **node_arguments)
        self.done = False
        p = build(RecorderParameters, ros_parameters.overrides(self))
        ros_parameters.declare(self, entries(p))
        self._directory = Path(p.directory)
        bag = self._directory / "bag" if p.bag else None
        if bag is not None and bag.exists():
            raise ParameterError(f"parameter directory: {p.directory!r} is refused, allowed is one without a bag")
        self._directory.mkdir(parents=True, exist_ok=True)
        topics = [topic for topic in TOPICS.values() if topic.name in p.topics]
        names = [self.resolve_topic_name(topic.name) for topic in topics]
        period = stamps.from_seconds(p.control_period)
        self._last = stamps.from_seconds(p.duration) // period * period
        realtime = p.mode == "realtime"
        self._recorder = RunRecorder(topics, names, period, bag, realtime, self._last or None)
        self._wrote = False
        self._told = -1
        self._clock_stamp = -1
        self._next_poll = 0.0
        # The master's first: nobody speaks of an instant before the master does, so nothing seems to be ahead of it.
        masters_first = sorted(enumerate(topics), key=lambda place: place[1].signal not in ROLES[MASTER].writes)
        self._all_subscriptions = [self._subscribe(index, topic) for index, topic in masters_first]
        if bag is not None:
            self._all_subscriptions += self._subscribe_beside()
        self._progress = SignalWriter(self, TOPICS[RECORDER_WRITES])
        self.create_timer(_POLL_PERIOD, self.idle, clock=RosClock(clock_type=ClockType.STEADY_TIME))

    def _subscribe(self, index: int, topic: Topic) -> Subscription:
        def receive(message: bytes) -> None:
            self._recorder.add(index, message)

        kind = message_class(topic.message_type)
        return self.create_subscription(kind, topic.name, receive, QUALITY, raw=True)

    def _subscribe_beside(self) -> tuple[Subscription, Subscription]:
        """What is no signal of the contract only goes into the bag."""
        return (
            self.create_subscription(Clock, "/clock", self._on_clock, QUALITY, raw=True),
            self.create_subscription(DiagnosticArray, "/diagnostics", self._on_diagnostics, QUALITY, raw=True),
        )

    def _on_clock(self, message: bytes) -> None:
        stamp = stamp_of(message)
        if stamp != self._clock_stamp:  # the master repeats the stamp where it repeats the state
            self._clock_stamp = stamp
            self._recorder.add_beside("/clock", "rosgraph_msgs/msg/Clock", message, stamp)

    def _on_diagnostics(self, message: bytes) -> None:
        stamp = max(self._clock_stamp, 0)
        self._recorder.add_beside("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray", message, stamp)

    def poll(self) -> bool:
        """Take every message that has arrived, now and then; False, so that the node rests in between."""
        if time.monotonic() < self._next_poll:
            return False
        self._next_poll = time.monotonic() + _POLL_PERIOD
        for subscription in self._all_subscriptions:
            handle = subscription.handle
            while (taken := handle.take_message(subscription.msg_type, True)) is not None:
                subscription.callback(taken[0])
        return False

    def sweep(self) -> None:
        """Nothing more to take: `poll` takes everything."""

    def awaits(self) -> None:
        """No message is worth waking up for: they are taken many at a time."""

    def wake_up_within(self) -> float:
        """Seconds of rest between two polls."""
        return _POLL_PERIOD

    def idle(self) -> None:
        """Tell how far the recording is, and end it when it is complete."""
        self._recorder.took_all()
        held = self._recorder.held
        if held != self._told or self._recorder.asked:
            if held >= 0:
                self._progress.write(held, _NOTHING)
            self._told, self._recorder.asked = held, False
        if self._recorder.loss:
            raise RuntimeError(f"the recording has a gap: {self._recorder.loss}")
        if 0 < self._last <= held:
            self._progress.publisher.wait_for_all_acked(Duration(seconds=2.0))
            self.finish()
            self.done = True
        self._recorder.checkpoint()

    def finish(self) -> None:
        """Write signals.npz with all complete steps and close the bag."""
        if not self._wrote:
            self._wrote = True
            self._recorder.close()
            save(self._recorder.recording(), self._directory / "signals.npz")

    def close(self) -> None:
        """Leave nothing unwritten behind."""
        self.finish()


def main() -> None:
    """ros2 run ev_sim recorder"""
    run_node("recorder", RecorderNode)
