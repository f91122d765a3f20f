"""Speaks in the name of a node for some seconds, by datagrams as its publisher would send: ROLE NUMBER [TO]."""

from __future__ import annotations

import socket
import sys
import time
from collections.abc import Sequence

import rclpy
from rclpy.node import Node

from campaign.forgeries import data, rtps
from campaign.ports import ports
from ev_core.lockstep.stepper import WRITERS
from ev_msgs_py.contract.frame import PLACES, Frame, numbers_of
from ev_msgs_py.contract.roles import RECORDER
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.wire import format_of, stamp_of
from ev_nodes.stepping.signal_io import QUALITY
from ev_nodes.stepping.stop_request import StopRequest
from ev_nodes.stepping.taking import taker_of

_SECONDS, _MOST = 30.0, 200  # then it has sent enough, or there was no reader


def main() -> None:
    """Say a number on the first topic of a role, one step ahead of its node, each time that it is heard.

    To whoever listens in the domain, or only to the node of the role that is named last.
    """
    role, number, to = sys.argv[1], float(sys.argv[2]), sys.argv[3:]
    topic = next(TOPICS[signal] for signal, writer in WRITERS.items() if writer == role)
    format_ = format_of(topic.signal)
    rclpy.init()
    node = Node("forger", namespace="/ev")
    ear = node.create_subscription(
        format_.message_class, topic.name, lambda _: None, QUALITY, raw=True
    )
    take = taker_of(ear.handle, format_.message_class)
    mouth = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    said, begun, before, count = Frame(), time.monotonic(), 0, 0
    where: list[int] = []
    said.numbers[PLACES[topic.signal]] = numbers_of(
        [number] * (PLACES[topic.signal].stop - PLACES[topic.signal].start)
    )
    print("here", flush=True)
    with StopRequest() as stop:
        while not stop.received and count < _MOST and time.monotonic() < begun + _SECONDS:
            taken = take()
            if taken is None:
                continue
            message, info = taken
            stamp = stamp_of(message)
            if stamp <= before or format_.read(message)[1] == list(
                said.numbers[PLACES[topic.signal]]
            ):
                continue  # repeated, or of ourselves
            gid, sequence = info["publisher_gid"]["data"], info["publication_sequence_number"]
            payload = format_.pack(2 * stamp - before, said)
            forged = rtps(bytes(gid), data(bytes(gid[12:16]), sequence + 1, payload))
            before, count = stamp, count + 1
            where = where or _ports(node, to)
            for port in where:
                mouth.sendto(forged, ("127.0.0.1", port))
    print(f"forged {count} messages of {topic.name}")
    rclpy.try_shutdown()


def _ports(node: Node, roles: Sequence[str]) -> list[int]:
    """Where the processes of roles listen, or all that are there without roles."""
    if not roles:
        return ports(lambda _: True)
    topics = [
        topic.name for signal, topic in TOPICS.items() if WRITERS.get(signal, RECORDER) in roles
    ]
    gids = [
        bytes(end.endpoint_gid)
        for name in topics
        for end in node.get_publishers_info_by_topic(f"/ev/{name}")
    ]
    # as Fast DDS puts them into identities
    processes = {int.from_bytes(gid[4:6], "little") for gid in gids}
    return ports(lambda process: process & 0xFFFF in processes)


if __name__ == "__main__":
    main()
