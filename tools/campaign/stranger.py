"""A process in the domain of a run that has no part in it, for some seconds: ACT RATE SEED."""

from __future__ import annotations

import itertools
import random
import sys
import time
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import rclpy
from rcl_interfaces.srv import SetParameters
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.signals import SignalHandlerOptions
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from std_srvs.srv import Trigger

from campaign.spoiling import HOW, spoilt
from ev_core.lockstep.stepper import WRITERS
from ev_msgs_py.contract.frame import Frame, numbers_of
from ev_msgs_py.contract.roles import RECORDER
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.wire import format_of, stamp_alone, stamp_of
from ev_nodes.stepping.signal_io import NAMELESS, QUALITY
from ev_nodes.stepping.stop_request import StopRequest

STEP, SECOND = 10**7, 10**9  # ns
_OTHER = 7.0  # a finite number that no run gives
_LARGE = 10**5  # names or numbers of a message
_SECONDS, _MESSAGES = 4.0, 20_000  # then it has sent enough
_PATIENCE, _MOMENT = 4.0, 0.3  # s
_WAITING = 200  # questions that are under way at once
_SUBSCRIBERS = 50
_BEST_EFFORT = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
_ALL = tuple(TOPICS)
_Goes = Callable[[], bool]  # whether it may go on


class Message(NamedTuple):
    """A message, also as bytes, and its topic; names without a slash are those of the car."""

    topic: str
    kind: type
    content: Any


class Publishing(NamedTuple):
    """An act: what a node of this name publishes in each round, with a stamp of the run [ns]."""

    about: str
    messages: Callable[[random.Random, int], Iterator[Message]]
    node: str = "stranger"
    namespace: str = "/ev"
    quality: QoSProfile = QUALITY


class Doing(NamedTuple):
    """An act: what a node does for as long as it may go on, so many times a second."""

    about: str
    do: Callable[[Node, _Goes, float], None]


def _signals(
    later: int = 0,
    *,
    at: int | None = None,
    value: float = _OTHER,
    signals: tuple[type, ...] = _ALL,
    is_spoilt: bool = False,
) -> Callable[[random.Random, int], Iterator[Message]]:
    """Signals in their own form with another number, so much later than the run, or `at` a stamp."""

    def messages(chance: random.Random, stamp: int) -> Iterator[Message]:
        frame = Frame()
        frame.numbers[:] = numbers_of([value] * len(frame.numbers))
        for signal in signals:
            format_ = format_of(signal)
            content = format_.pack(stamp + later if at is None else at, frame)
            if is_spoilt:
                content = spoilt(content, chance.choice(HOW), chance)
            yield Message(format_.topic.name, format_.message_class, content)

    return messages


def _of(role: str) -> tuple[type, ...]:
    return tuple(signal for signal in _ALL if WRITERS.get(signal, RECORDER) == role)


def _other_clock(chance: random.Random, stamp: int) -> Iterator[Message]:
    other = stamp + chance.randrange(SECOND, 10 * SECOND)
    yield Message("/clock", Clock, stamp_alone(other))


def _other_type(_: random.Random, stamp: int) -> Iterator[Message]:
    for topic in TOPICS.values():
        yield Message(topic.name, String, String(data=f"{stamp}"))


def _large(_: random.Random, stamp: int) -> Iterator[Message]:
    """Joint states that are not those of a car."""
    content = JointState(name=[f"j{n}" for n in range(_LARGE)], velocity=[_OTHER] * _LARGE)
    content.header.stamp.sec, content.header.stamp.nanosec = divmod(stamp, SECOND)
    for topic in TOPICS.values():
        if topic.message_type == "sensor_msgs/msg/JointState":
            yield Message(topic.name, JointState, content)


def _stops_time(node: Node, goes_on: _Goes, _: float) -> None:
    """Let the run go step by step; time goes on behind that in any case."""
    for name in ("pause", "step", "step", "resume"):
        client = node.create_client(Trigger, f"/ev/plant/{name}")
        if not client.wait_for_service(timeout_sec=_PATIENCE):
            return
        if goes_on() or name == "resume":
            call = client.call_async(Trigger.Request())
            rclpy.spin_until_future_complete(node, call, timeout_sec=_PATIENCE)
            time.sleep(_MOMENT)


def _sets_parameters(node: Node, goes_on: _Goes, rate: float) -> None:
    """Flood nodes with parameters that do not exist."""
    parameter = Parameter("no.such", value=float("nan")).to_parameter_msg()
    roles = ("plant", "asr", "driver", "recorder")
    clients = [node.create_client(SetParameters, f"/ev/{role}/set_parameters") for role in roles]
    asked: list[Any] = []
    for client in itertools.cycle(clients):
        if not goes_on():
            return
        asked = [future for future in asked if not future.done()][-_WAITING:]
        asked.append(client.call_async(SetParameters.Request(parameters=[parameter])))
        rclpy.spin_once(node, timeout_sec=1.0 / rate)


def _comes_and_goes(_: Node, goes_on: _Goes, rate: float) -> None:
    """Join the graph and leave it, with nodes of the run's names."""
    while goes_on():
        context = rclpy.Context()
        rclpy.init(context=context)
        for name in ("plant", "asr", "recorder"):
            Node(name, namespace="/ev", context=context)
        time.sleep(1.0 / rate)
        context.try_shutdown()


def _never_takes(node: Node, goes_on: _Goes, rate: float) -> None:
    """Subscribe many times and take nothing."""
    for signal, topic in itertools.islice(itertools.cycle(TOPICS.items()), _SUBSCRIBERS):
        kind = format_of(signal).message_class
        node.create_subscription(kind, topic.name, lambda _: None, QUALITY)
    while goes_on():
        time.sleep(1.0 / rate)


_TWIN = _signals(STEP, signals=_of("asr"))
_OTHER_PLANT = _signals(at=0, signals=_of("plant"))
_HOLDS_ALL = _signals(1000 * SECOND, signals=_of(RECORDER))
ACTS: dict[str, Publishing | Doing] = {
    "same stamp": Publishing("other numbers under the right stamp", _signals()),
    "next stamp": Publishing("other numbers of the next step", _signals(STEP)),
    "stamp zero": Publishing("as if the run began again", _signals(at=0)),
    "not finite": Publishing("NaN in all places", _signals(value=float("nan"))),
    "spoilt": Publishing("messages that no node can read", _signals(is_spoilt=True)),
    "best effort": Publishing("another quality of service", _signals(STEP), quality=_BEST_EFFORT),
    "another type": Publishing("texts on all topics", _other_type),
    "large": Publishing("joint states of a megabyte", _large),
    "clock": Publishing("other times", _other_clock),
    "twin of asr": Publishing("a second node asr", _TWIN, "asr"),
    "twin of the plant": Publishing("a second plant, which begins again", _OTHER_PLANT, "plant"),
    "twin of the recorder": Publishing("a recorder that holds all", _HOLDS_ALL, RECORDER),
    "asr of another car": Publishing("a node asr elsewhere", _signals(STEP), "asr", "/other"),
    "nameless": Publishing("a node without a name", _signals(STEP), f"{NAMELESS}asr{NAMELESS}"),
    "stops time": Doing("lets the run go step by step", _stops_time),
    "sets parameters": Doing("a flood of parameters that do not exist", _sets_parameters),
    "comes and goes": Doing("joins the graph and leaves it", _comes_and_goes),
    "never takes": Doing("fifty subscriptions that take nothing", _never_takes),
}


def main() -> None:
    """Go on until a stop is asked for, at most some seconds and some thousand messages."""
    act, rate, chance = ACTS[sys.argv[1]], float(sys.argv[2]), random.Random(int(sys.argv[3]))
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    end = time.monotonic() + _SECONDS
    with StopRequest() as stop:

        def goes_on() -> bool:
            return not stop.received and time.monotonic() < end

        if isinstance(act, Publishing):
            _publish(act, chance, goes_on, rate)
        else:
            act.do(Node("stranger", namespace="/ev"), goes_on, rate)
    rclpy.try_shutdown()


def _publish(act: Publishing, chance: random.Random, goes_on: _Goes, rate: float) -> None:
    node = Node(act.node, namespace=act.namespace)
    clock = node.create_subscription(Clock, "/clock", lambda _: None, QUALITY, raw=True).handle
    publishers: dict[str, Publisher] = {}
    stamp = count = 0
    while goes_on() and count < _MESSAGES:
        while (taken := clock.take_message(Clock, True)) is not None:
            stamp = max(stamp, stamp_of(taken[0]))
        for topic, kind, content in act.messages(chance, stamp):
            if topic not in publishers:
                name = topic if topic.startswith("/") else f"/ev/{topic}"
                publishers[topic] = node.create_publisher(kind, name, act.quality)
            publishers[topic].publish(content)
            count += 1
        time.sleep(1.0 / rate)


if __name__ == "__main__":
    main()
