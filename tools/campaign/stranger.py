"""Speaks on all topics of a run for some seconds, and is nobody of it: ACT RATE SEED."""

from __future__ import annotations

import random
import sys
import time

import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from std_srvs.srv import Trigger

from campaign.spoiling import HOW, spoilt
from ev_msgs_py.contract.frame import Frame, numbers_of
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.nodes.signal_io import QUALITY
from ev_msgs_py.nodes.stop_request import StopRequest
from ev_msgs_py.wire.message_format import format_of, stamp_alone, stamp_of

ACTS = (
    "same stamp",
    "same stamp",
    "next stamp",
    "later stamp",
    "stamp zero",
    "spoilt",
    "clock",
    "diagnostics",
    "pause",
)
_SECONDS = 4.0  # then it has said enough
_OTHER = 7.0  # a finite number that no run gives


def main() -> None:
    """Speak until told to stop, at most some seconds and some thousand messages."""
    act, rate, seed = sys.argv[1], float(sys.argv[2]), int(sys.argv[3])
    chance = random.Random(seed)
    rclpy.init()
    node = Node("stranger", namespace="/ev")
    hears = node.create_subscription(Clock, "/clock", lambda _: None, QUALITY, raw=True).handle
    formats = [format_of(signal) for signal in TOPICS]
    mouths = [node.create_publisher(f.message_class, f.topic.name, QUALITY) for f in formats]
    clock = node.create_publisher(Clock, "/clock", QUALITY)
    diagnostics = node.create_publisher(DiagnosticArray, "/diagnostics", QUALITY)
    other = Frame()
    other.numbers[:] = numbers_of([_OTHER] * len(other.numbers))
    stamp, begun = 0, time.monotonic()
    if act == "pause":
        _pause(node)
    with StopRequest() as stop:
        while not stop.received and time.monotonic() < begun + _SECONDS and act != "pause":
            while (taken := hears.take_message(Clock, True)) is not None:
                stamp = max(stamp, stamp_of(taken[0]))
            said = {"next stamp": stamp + 10**7, "later stamp": stamp + 5 * 10**9, "stamp zero": 0}.get(act, stamp)
            if act == "clock":
                clock.publish(stamp_alone(stamp + chance.randrange(-(10**9), 10**10) if stamp > 10**9 else 10**12))
            elif act == "diagnostics":
                status = DiagnosticStatus(level=DiagnosticStatus.ERROR, name="/ev/plant", message="I am nobody")
                diagnostics.publish(DiagnosticArray(status=[status]))
            else:
                for format_, mouth in zip(formats, mouths, strict=True):
                    message = format_.pack(said, other)
                    mouth.publish(spoilt(message, chance.choice(HOW), chance) if act == "spoilt" else message)
            time.sleep(1.0 / rate)
    rclpy.try_shutdown()


def _pause(node: Node) -> None:
    """Stop time for a moment, and let it go on."""
    for name in ("pause", "resume"):
        client = node.create_client(Trigger, f"/ev/plant/{name}")
        if client.wait_for_service(timeout_sec=_SECONDS):
            rclpy.spin_until_future_complete(node, client.call_async(Trigger.Request()), timeout_sec=_SECONDS)
        time.sleep(0.3)


if __name__ == "__main__":
    main()
