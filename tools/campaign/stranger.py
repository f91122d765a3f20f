"""Is in the domain of a run for some seconds, and is nobody of it: ACT RATE SEED."""

from __future__ import annotations

import os
import random
import socket
import sys
import time
from collections.abc import Callable

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.signals import SignalHandlerOptions
from rosgraph_msgs.msg import Clock

from campaign.doings import DOINGS
from campaign.forgeries import FORGERIES, Forgery, Heard
from campaign.ports import ports
from campaign.sayings import SAYINGS, Saying
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.wire import format_of, stamp_of
from ev_nodes.stepping.signal_io import QUALITY
from ev_nodes.stepping.stop_request import StopRequest
from ev_nodes.stepping.taking import taker_of

ACTS = (*SAYINGS, *DOINGS, *FORGERIES)
_SECONDS, _MESSAGES, _DATAGRAMS = 4.0, 20_000, 40_000  # then it has sent enough
_MOMENT, _LOOKS = 0.0005, 20.0  # s between looks for a message, and looks into the graph a second
CLASSES = {topic.name: format_of(signal).message_class for signal, topic in TOPICS.items()}
CLASSES |= {"/clock": Clock, "/diagnostics": DiagnosticArray}


def main() -> None:
    """Go on until told to stop, at most some seconds and some thousand messages."""
    act, rate, chance = sys.argv[1], float(sys.argv[2]), random.Random(int(sys.argv[3]))
    saying = SAYINGS.get(act)
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = Node(
        saying.node if saying else "stranger", namespace=saying.namespace if saying else "/ev"
    )
    end = time.monotonic() + _SECONDS
    with StopRequest() as stop:

        def goes_on() -> bool:
            return not stop.received and time.monotonic() < end

        if saying is not None:
            _say(node, saying, chance, goes_on, rate)
        elif act in DOINGS:
            DOINGS[act].do(node, goes_on, rate)
        else:
            _forge(node, FORGERIES[act], chance, goes_on, rate)
    rclpy.try_shutdown()


def _say(
    node: Node, saying: Saying, chance: random.Random, goes_on: Callable[[], bool], rate: float
) -> None:
    hears = node.create_subscription(Clock, "/clock", lambda _: None, QUALITY, raw=True).handle
    mouths: dict[str, Publisher] = {}
    stamp = count = 0
    while goes_on() and count < _MESSAGES:
        while (taken := hears.take_message(Clock, True)) is not None:
            stamp = max(stamp, stamp_of(taken[0]))
        for topic, kind, message in saying.say(chance, stamp):
            if topic not in mouths:
                name = topic if topic.startswith("/") else f"/ev/{topic}"
                mouths[topic] = node.create_publisher(kind, name, saying.quality)
            mouths[topic].publish(message)
            count += 1
        time.sleep(1.0 / rate)


def _forge(
    node: Node, forgery: Forgery, chance: random.Random, goes_on: Callable[[], bool], rate: float
) -> None:
    """Forge once for each message that is heard, and some times a second without one."""
    topic = forgery.topic if forgery.topic.startswith("/") else f"/ev/{forgery.topic}"
    kind = CLASSES[forgery.topic]
    ear = node.create_subscription(kind, topic, lambda _: None, QUALITY, raw=True)
    take = taker_of(ear.handle, kind)
    heard, count, due = Heard(bytes(16), 0, b""), 0, 0.0
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as mouth:
        while goes_on() and count < _DATAGRAMS:
            if (taken := take()) is not None:
                message, info = taken
                heard = Heard(
                    bytes(info["publisher_gid"]["data"]),
                    info["publication_sequence_number"],
                    message,
                )
            elif (now := time.monotonic()) < due:
                time.sleep(_MOMENT)
                continue
            else:
                due = now + 1.0 / min(rate, _LOOKS)
                where = ports(lambda process: process != os.getpid())
                ends = [
                    bytes(each.endpoint_gid) for each in node.get_publishers_info_by_topic(topic)
                ]
                if heard.gid not in ends:
                    heard = heard._replace(gid=chance.choice(ends or [bytes(16)]))
            for datagram in forgery.forge(chance, heard):
                for port in where:
                    mouth.sendto(datagram, ("127.0.0.1", port))
                    count += 1


if __name__ == "__main__":
    main()
