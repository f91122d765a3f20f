"""How the messages of one topic look: a template, and runs of numbers between frame and message.

Making a message object, filling it and letting the middleware serialize it costs some fifty microseconds, and as much
to take one apart; a node does this several times per step. The places never change within a topic, so a few copies of
bytes do the same. What another sender wrote in another layout (joints in another order, another frame name) is still
read, by way of the message object.
"""

from __future__ import annotations

import math
import struct
from functools import cache
from typing import Any, NamedTuple

from rclpy.serialization import deserialize_message

from ev_msgs_py.contract import frame, stamps
from ev_msgs_py.contract.topics import TOPICS, Topic
from ev_msgs_py.wire.cdr import ENCAPSULATION, Serialized
from ev_msgs_py.wire.layout import MessageError, empty_message, numbers_in, paths
from ev_msgs_py.wire.message_classes import message_class

STAMP_AT = len(ENCAPSULATION)  # every message of the contract begins with its stamp
_STAMP = struct.Struct("<iI")
_DOUBLE = 8


class Run(NamedTuple):
    """Numbers in a row in frame and message: first place in the frame, offset in the message, and how many."""

    place: int
    offset: int
    length: int


class MessageFormat:
    """`template` is a whole message, `runs` say where its numbers are, and `code` is their struct code, d or f."""

    def __init__(self, topic: Topic) -> None:
        self.topic = topic
        self.message_class = message_class(topic.message_type)
        serialized = Serialized(empty_message(topic, self.message_class))
        self.template = serialized.bytes
        found = [serialized.places[path] for path in paths(topic)]
        self.code = found[0][1] if found else "d"
        self.size = struct.calcsize(self.code)
        self.offsets = [offset for offset, _ in found]
        where = frame.PLACES.get(topic.signal, slice(0, 0))
        self.runs = _runs(where.start, self.offsets, self.size)
        self._raw_runs = [
            (slice(r.offset, r.offset + r.length * _DOUBLE), slice(r.place * _DOUBLE, (r.place + r.length) * _DOUBLE))
            for r in self.runs
        ]
        self._where = where
        self._constants = [(slice(begin, end), self.template[begin:end]) for begin, end in self._gaps()]
        self._numbers = struct.Struct("<" + "".join(self._codes()))
        order = sorted(range(len(self.offsets)), key=self.offsets.__getitem__)
        self._rank = [order.index(i) for i in range(len(order))]

    def _gaps(self) -> list[tuple[int, int]]:
        """Beginnings and ends of the constant bytes behind the stamp."""
        gaps, end = [], STAMP_AT + _STAMP.size
        for run in sorted(self.runs, key=lambda run: run.offset):
            gaps.append((end, run.offset))
            end = run.offset + run.length * self.size
        return [(begin, end) for begin, end in [*gaps, (end, len(self.template))] if end > begin]

    def _codes(self) -> list[str]:
        """Struct codes of the numbers in the order of the message, with what lies between them left out."""
        codes, end = [], 0
        for run in sorted(self.runs, key=lambda run: run.offset):
            codes.append(f"{run.offset - end}x{run.length}{self.code}")
            end = run.offset + run.length * self.size
        return [*codes, f"{len(self.template) - end}x"]

    def pack(self, stamp: int, here: frame.Frame) -> bytes:
        """The message with this stamp and the numbers of a frame, which must be finite."""
        message = bytearray(self.template)  # the middleware copies it
        _STAMP.pack_into(message, STAMP_AT, *divmod(stamp, stamps.NANOSECONDS))
        if self.code == "d":
            for in_message, in_frame in self._raw_runs:
                message[in_message] = here.raw[in_frame]
        else:
            for place, offset, count in self.runs:
                struct.pack_into(f"<{count}{self.code}", message, offset, *here.numbers[place : place + count])
        return bytes(message)

    def canonical(self, message: bytes) -> bytes:
        """A message in our own layout, whoever has sent it; MessageError if it is refused."""
        if len(message) != len(self.template):
            return self._rewritten(message)
        for where, constant in self._constants:
            if message[where] != constant:
                return self._rewritten(message)
        numbers = self._numbers.unpack(message)
        if not math.isfinite(sum(numbers)):  # or just large: their sum overflows
            self._refuse_not_finite([numbers[rank] for rank in self._rank])
        return message

    def _rewritten(self, message: bytes) -> bytes:
        try:
            stamp = stamp_of(message)
            read: Any = deserialize_message(message, self.message_class)
        except Exception as error:
            raise MessageError(f"{len(message)} bytes are no {self.topic.message_type}: {error}") from None
        numbers = numbers_in(self.topic, read)
        self._refuse_not_finite(numbers)
        rewritten = frame.Frame()
        rewritten.numbers[self._where] = frame.numbers_of(numbers)
        return self.pack(stamp, rewritten)

    def _refuse_not_finite(self, numbers: list[float]) -> None:
        for channel, value in zip(self.topic.shape.channels, numbers, strict=True):
            if not math.isfinite(value):
                raise MessageError(f"{channel} is {value}, allowed are finite numbers")

    def unpack(self, message: bytes, here: frame.Frame) -> None:
        """Put the numbers of a canonical message into a frame."""
        if self.code == "d":
            for in_message, in_frame in self._raw_runs:
                here.raw[in_frame] = message[in_message]
        else:
            numbers = self._numbers.unpack(message)
            here.numbers[self._where] = frame.numbers_of([numbers[rank] for rank in self._rank])


def _runs(place: int, offsets: list[int], size: int) -> tuple[Run, ...]:
    runs: list[Run] = []
    for i, offset in enumerate(offsets):
        last = runs[-1] if runs else None
        if last is not None and offset == last.offset + last.length * size:
            runs[-1] = last._replace(length=last.length + 1)
        else:
            runs.append(Run(place + i, offset, 1))
    return tuple(runs)


@cache
def format_of(signal: type) -> MessageFormat:
    """The format of the topic that carries a signal."""
    return MessageFormat(TOPICS[signal])


def stamp_of(message: bytes) -> int:
    """The stamp in a serialized message of the contract, in nanoseconds; MessageError if it is too short for one."""
    if len(message) < STAMP_AT + _STAMP.size or message[:2] != ENCAPSULATION[:2]:
        raise MessageError(f"{len(message)} bytes, beginning with {message[:STAMP_AT].hex()}, carry no stamp")
    seconds: int
    nanoseconds: int
    seconds, nanoseconds = _STAMP.unpack_from(message, STAMP_AT)
    return seconds * stamps.NANOSECONDS + nanoseconds


def stamp_alone(stamp: int) -> bytes:
    """A serialized message that is nothing but a stamp, as /clock is."""
    return ENCAPSULATION + _STAMP.pack(*divmod(stamp, stamps.NANOSECONDS))
