"""Datagrams that a stranger forges (OMG DDSI-RTPS 2.3, 8.3.7 and 9.4.5): one entry for each act, by its name."""

from __future__ import annotations

import random
import struct
from collections.abc import Callable, Iterator
from typing import NamedTuple

from campaign.sayings import ESCAPES, INVENTED, SECOND, STEP
from ev_msgs_py.wire import STAMP_AT

_DATA, _HEARTBEAT, _ACKNACK, _GAP = 0x15, 0x07, 0x06, 0x08  # kinds of submessages
_EVERYBODY = bytes(4)  # in the place of a reader
_OTHER = struct.pack("<d", 7.0)  # a finite number that no run gives
# built-in writer and reader of what is said of processes
_OF_PROCESSES = b"\x00\x01\x00\xc2", b"\x00\x01\x00\xc7"
_OF_PUBLISHERS = b"\x00\x00\x03\xc2", b"\x00\x00\x03\xc7"
_PROCESS = b"\x00\x00\x01\xc1"
_KEY_HASH, _STATUS, _PROCESS_KEY, _PUBLISHER_KEY, _END = 0x70, 0x71, 0x50, 0x5A, 1  # of parameters
_GONE = struct.pack(">I", 3)  # disposed and unregistered


class Heard(NamedTuple):
    """Who has published on a topic (16 bytes), and what: the number in its stream, and the message."""

    gid: bytes
    sequence: int
    message: bytes


class Forgery(NamedTuple):
    """What is sent to all ports of the domain, as from whoever publishes on the topic."""

    about: str
    topic: str
    forge: Callable[[random.Random, Heard], Iterator[bytes]]


def rtps(gid: bytes, *submessages: bytes) -> bytes:
    """A message as of the process of a publisher."""
    return b"RTPS\x02\x03\x01\x0f" + gid[:12] + b"".join(submessages)


def data(writer: bytes, sequence: int, payload: bytes, reader: bytes = _EVERYBODY) -> bytes:
    """A DATA submessage."""
    body = (
        struct.pack("<HH", 0, 16)
        + reader
        + writer
        + _number(sequence)
        + payload
        + bytes(-len(payload) % 4)
    )
    return _submessage(_DATA, 0x05, body)


def _number(sequence: int) -> bytes:
    return struct.pack("<iI", sequence >> 32, sequence & 0xFFFFFFFF)


def _submessage(kind: int, flags: int, body: bytes) -> bytes:
    return struct.pack("<BBH", kind, flags, len(body)) + body


def _message(
    later: int, end: bytes = _OTHER, ahead: int = 1
) -> Callable[[random.Random, Heard], Iterator[bytes]]:
    """The next message of a publisher, before it says it itself, with another last number."""

    def forge(_: random.Random, heard: Heard) -> Iterator[bytes]:
        if len(heard.message) >= STAMP_AT + 8:
            seconds, nanoseconds = struct.unpack_from("<iI", heard.message, STAMP_AT)
            stamp = struct.pack("<iI", *divmod(seconds * SECOND + nanoseconds + later, SECOND))
            rest = heard.message[STAMP_AT + 8 :]
            payload = (
                heard.message[:STAMP_AT]
                + stamp
                + rest[: max(len(rest) - len(end), 0)]
                + end[: len(rest)]
            )
            yield rtps(heard.gid, data(heard.gid[12:16], heard.sequence + ahead, payload))

    return forge


def _diagnostics(chance: random.Random, heard: Heard) -> Iterator[bytes]:
    text = (ESCAPES + INVENTED).encode()
    body = b"\x00\x01\x00\x00" + struct.pack("<iIIxxxxI", 1, 0, 1, 1) + b"\x02" + bytes(3)
    for word in (b"/ev/plant", text):
        body += struct.pack("<I", len(word) + 1) + word + bytes(1 + -(len(word) + 1) % 4)
    for sequence in range(1, 40):
        yield rtps(heard.gid, data(heard.gid[12:16], sequence, body + bytes(4)))


def _noise(chance: random.Random, heard: Heard) -> Iterator[bytes]:
    yield chance.randbytes(chance.choice((0, 1, 4, 20, 100, 1400, 60_000)))
    yield rtps(heard.gid, chance.randbytes(chance.randrange(200)))


def _cut_off(chance: random.Random, heard: Heard) -> Iterator[bytes]:
    whole = rtps(heard.gid, data(heard.gid[12:16], heard.sequence + 1, heard.message))
    yield whole[: chance.randrange(len(whole))]


def _wrong_lengths(chance: random.Random, heard: Heard) -> Iterator[bytes]:
    whole = bytearray(
        rtps(heard.gid, data(heard.gid[12:16], heard.sequence + chance.randrange(9), heard.message))
    )
    # of the submessage
    struct.pack_into("<H", whole, 22, chance.choice((0, 1, 3, 19, 21, 40_000, 65_535)))
    if chance.random() < 0.5:
        # to what it has inside
        struct.pack_into("<H", whole, 26, chance.choice((0, 1, 15, 17, 60_000, 65_535)))
    yield bytes(whole)


def _heartbeats(chance: random.Random, heard: Heard) -> Iterator[bytes]:
    """All before a number is lost, and there is much that nobody has heard."""
    for first, last in ((2**40, 2**40 + 100), (1, 2**62), (2**62, 2**63 - 1), (5, 1)):
        count = struct.pack("<I", chance.getrandbits(31))
        body = _EVERYBODY + heard.gid[12:16] + _number(first) + _number(last) + count
        yield rtps(heard.gid, _submessage(_HEARTBEAT, 0x01, body))


def _acknacks(chance: random.Random, heard: Heard) -> Iterator[bytes]:
    """All that is to come has been heard, or nothing at all, or a set of 2^32 numbers is missing."""
    for base, bits in (
        (2**40, 0),
        (1, 256),
        (heard.sequence, 32),
        (0, 2**32 - 1),
        (2**63 - 1, 256),
    ):
        numbers = _number(base) + struct.pack("<I", bits) + b"\xff" * 32
        body = _EVERYBODY + heard.gid[12:16] + numbers + struct.pack("<I", chance.getrandbits(31))
        yield rtps(
            heard.gid[:11] + bytes([chance.randrange(256)]), _submessage(_ACKNACK, 0x01, body)
        )
        yield rtps(heard.gid, _submessage(_ACKNACK, 0x03, body))


def _gaps(_: random.Random, heard: Heard) -> Iterator[bytes]:
    """What a publisher says next does not count."""
    first, after = heard.sequence + 1, heard.sequence + 50
    body = _EVERYBODY + heard.gid[12:16] + _number(first) + _number(after) + bytes(4)
    yield rtps(heard.gid, _submessage(_GAP, 0x01, body))


def _has_left(
    ends: tuple[bytes, bytes], key: int, entity: bytes = b""
) -> Callable[[random.Random, Heard], Iterator[bytes]]:
    """A process or a publisher says that it is no more."""
    writer, reader = ends

    def forge(_: random.Random, heard: Heard) -> Iterator[bytes]:
        who = heard.gid[:12] + (entity or heard.gid[12:16])
        quality = _parameter(_STATUS, _GONE) + _parameter(_KEY_HASH, who) + _parameter(_END)
        payload = b"\x00\x03\x00\x00" + _parameter(key, who) + _parameter(_END)
        for sequence in (*range(1, 40), 2**31):
            body = (
                struct.pack("<HH", 0, 16) + reader + writer + _number(sequence) + quality + payload
            )
            yield rtps(heard.gid, _submessage(_DATA, 0x0B, body))

    return forge


def _parameter(kind: int, value: bytes = b"") -> bytes:
    return struct.pack("<HH", kind, len(value)) + value


FORGERIES = {
    "noise": Forgery("random bytes", "torque_command", _noise),
    "cut off": Forgery("messages without their ends", "torque_command", _cut_off),
    "wrong lengths": Forgery("messages that say another length", "wheel_states", _wrong_lengths),
    "forged commands": Forgery("commands as of asr", "torque_command", _message(STEP)),
    "forged driver": Forgery("what the law reads, as of the driver", "driver/command", _message(STEP)),
    "forged plant": Forgery("what driver and laws read, as of the plant", "twist", _message(STEP)),
    "forged plant, later": Forgery("what comes in a second, as of the plant", "twist", _message(SECOND, ahead=100)),
    "forged progress": Forgery("as if the recorder held all", "recorder/progress", _message(1000 * SECOND, b"")),
    "forged clock": Forgery("other times, as of the plant", "/clock", _message(1000 * SECOND, b"")),
    "forged diagnostics": Forgery("words as of a node of the run", "/diagnostics", _diagnostics),
    "heartbeats": Forgery("there is more than anybody has heard", "torque_command", _heartbeats),
    "acknowledgements": Forgery("readers that miss all or nothing", "wheel_states", _acknacks),
    "gaps": Forgery("the next commands do not count", "torque_command", _gaps),
    "process has left": Forgery("a node is gone", "torque_command", _has_left(_OF_PROCESSES, _PROCESS_KEY, _PROCESS)),
    "publisher has left": Forgery("nobody commands", "torque_command", _has_left(_OF_PUBLISHERS, _PUBLISHER_KEY)),
}  # fmt: skip
