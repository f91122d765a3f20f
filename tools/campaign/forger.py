"""Speaks in the name of a node for some seconds, by datagrams as its publisher would send: ROLE NUMBER [TO]."""

from __future__ import annotations

import os
import socket
import struct
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

import rclpy
from rclpy.node import Node

from ev_msgs_py.contract.frame import PLACES, Frame, numbers_of
from ev_msgs_py.contract.roles import RECORDER
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.lockstep.stepper import WRITERS
from ev_msgs_py.nodes.signal_io import QUALITY
from ev_msgs_py.nodes.stop_request import StopRequest
from ev_msgs_py.wire.message_format import format_of, stamp_of

_SECONDS, _MOST = 30.0, 200  # then it has said enough, or there was nobody to hear
_PARTICIPANTS = 16  # of a domain, at most: each has a port of its own


def main() -> None:
    """Say a number on the first topic of a role, one step ahead of its node, each time that it is heard.

    To whoever listens in the domain, or only to the node of the role that is named last.
    """
    role, number, to = sys.argv[1], float(sys.argv[2]), sys.argv[3:]
    topic = next(TOPICS[signal] for signal, writer in WRITERS.items() if writer == role)
    format_ = format_of(topic.signal)
    rclpy.init()
    node = Node("forger", namespace="/ev")
    ear = node.create_subscription(format_.message_class, topic.name, lambda _: None, QUALITY, raw=True).handle
    mouth = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    said, begun, before, count = Frame(), time.monotonic(), 0, 0
    ports: Sequence[int] = ()
    said.numbers[PLACES[topic.signal]] = numbers_of([number] * (PLACES[topic.signal].stop - PLACES[topic.signal].start))
    print("here", flush=True)
    with StopRequest() as stop:
        while not stop.received and count < _MOST and time.monotonic() < begun + _SECONDS:
            taken = ear.take_message(format_.message_class, True)
            if taken is None:
                continue
            message, info = taken
            stamp = stamp_of(message)
            if stamp <= before or format_.read(message)[1] == list(said.numbers[PLACES[topic.signal]]):
                continue  # repeated, or of ourselves
            gid, sequence = info["publisher_gid"]["data"], info["publication_sequence_number"]
            forged = _datagram(gid, sequence + 1, format_.pack(2 * stamp - before, said))
            before, count = stamp, count + 1
            ports = ports or _ports(node, to)
            for port in ports:
                mouth.sendto(forged, ("127.0.0.1", port))
    print(f"forged {count} messages of {topic.name}")
    rclpy.try_shutdown()


def _ports(node: Node, roles: Sequence[str]) -> Sequence[int]:
    """Where the processes of roles listen, or all that are there without roles."""
    first = 7411 + 250 * int(os.environ.get("ROS_DOMAIN_ID", "0"))
    if not roles:
        return range(first, first + 2 * _PARTICIPANTS, 2)
    topics = [topic.name for signal, topic in TOPICS.items() if WRITERS.get(signal, RECORDER) in roles]
    gids = [bytes(end.endpoint_gid) for name in topics for end in node.get_publishers_info_by_topic(f"/ev/{name}")]
    processes = {int.from_bytes(gid[4:6], "little") for gid in gids}  # as Fast DDS puts them into identities
    sockets: set[str] = set()
    for entry in Path("/proc").glob("[0-9]*/fd/*"):
        if int(entry.parts[2]) & 0xFFFF in processes:
            with suppress(OSError):
                sockets.add(entry.readlink().name)
    lines = [line.split() for line in Path("/proc/net/udp").read_text().splitlines()[1:]]
    ports = [int(line[1].partition(":")[2], 16) for line in lines if f"socket:[{line[9]}]" in sockets]
    return [port for port in ports if first <= port < first + 2 * _PARTICIPANTS]


def _datagram(gid: bytes, sequence: int, payload: bytes) -> bytes:
    """An RTPS message with one DATA submessage (OMG DDSI-RTPS 2.3, 8.3.7.2 and 9.4.5.3), to all readers."""
    numbered = struct.pack("<iI", sequence >> 32, sequence & 0xFFFFFFFF)
    data = struct.pack("<HH", 0, 16) + bytes(4) + gid[12:16] + numbered + payload + bytes(-len(payload) % 4)
    return b"RTPS\x02\x03\x01\x0f" + gid[:12] + struct.pack("<BBH", 0x15, 0x05, len(data)) + data


if __name__ == "__main__":
    main()
