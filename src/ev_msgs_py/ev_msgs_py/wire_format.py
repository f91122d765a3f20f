"""The serialized messages of one topic: constant bytes, with stamp and numbers at fixed places between them.

Making a message object, filling it and letting the middleware serialize it costs some fifty microseconds, and as much
to take one apart; a node of the graph does this several times per step. The places never change within a topic, so
one call of `struct` does the same. What another sender wrote in another layout (joints in another order, another
frame name) is still read, by way of the message object.
"""

from __future__ import annotations

import struct
from functools import cache
from operator import itemgetter
from typing import Any

from rclpy.serialization import deserialize_message

from ev_msgs_py import cdr, stamps
from ev_msgs_py.message_classes import message_class
from ev_msgs_py.topics import TOPICS, Topic

STAMP_AT = 4  # behind the encapsulation header: every message of the contract begins with its stamp
_PROBE = 12345.5  # exact in single precision, and no other part of a message looks like it


class WireFormat:
    """How the messages of a topic look on the wire.

    `template` is a whole message, `places` are the offsets of the numbers in it in order of the channels, and
    `number` is their struct code, d or f.
    """

    def __init__(self, topic: Topic) -> None:
        self.codec = topic.codec
        self.message_class = message_class(topic.codec.message_type)
        probe = tuple(_PROBE + i for i in range(len(topic.channels)))
        message = topic.codec.prepare(self.message_class())
        header = getattr(message, "header", message)
        header.frame_id = topic.frame
        topic.codec.encode(topic.codec.shape.signal_of(probe), message)
        self.template = cdr.serialize(message)
        self.number = "d" if not probe or struct.pack("<d", probe[0]) in self.template else "f"
        self.places = tuple(self.template.index(struct.pack(f"<{self.number}", number)) for number in probe)
        self._make_struct()

    def _make_struct(self) -> None:
        """Describe the message as fields of `struct`: stamp, numbers, and the constant bytes around them."""
        count = len(self.places)
        size = struct.calcsize(self.number)
        varying = [(STAMP_AT, 8, "iI", (0, 1))]
        varying += [(place, size, self.number, (2 + i,)) for i, place in enumerate(self.places)]
        codes, constants, sources, end = "<", [], [], 0
        for place, length, code, values in [*sorted(varying), (len(self.template), 0, "", ())]:
            if place > end:
                sources.append(2 + count + len(constants))
                constants.append(self.template[end:place])
                codes += f"{place - end}s"
            codes += code
            sources += values
            end = place + length
        self._struct = struct.Struct(codes)
        self._constants = tuple(constants)
        self._in_order = itemgetter(*sources)
        where = {source: position for position, source in enumerate(sources)}
        self._gather = itemgetter(*(where[i] for i in range(len(sources))))
        self._numbers = slice(2, 2 + count)

    def pack(self, stamp: int, signal: Any) -> bytes:
        """The message of a signal; SignalError if one of its numbers is not finite."""
        numbers = self.codec.numbers(signal)
        return self._struct.pack(
            *self._in_order((*divmod(stamp, stamps.NANOSECONDS), *numbers, *self._constants))
        )

    def unpack(self, message: bytes) -> tuple[int, Any]:
        """Stamp and signal of a message; MessageError if it is refused."""
        if len(message) == self._struct.size:
            fields = self._gather(self._struct.unpack(message))
            if fields[self._numbers.stop :] == self._constants:
                stamp = fields[0] * stamps.NANOSECONDS + fields[1]
                return stamp, self.codec.signal_with(fields[self._numbers])
        return stamp_of(message), self.codec.decode(deserialize_message(message, self.message_class))


@cache
def wire_format(signal: type) -> WireFormat:
    """The wire format of the topic that carries a signal."""
    return WireFormat(TOPICS[signal])


def stamp_of(message: bytes) -> int:
    """The stamp in a serialized message of the contract, in nanoseconds."""
    seconds, nanoseconds = struct.unpack_from("<iI", message, STAMP_AT)
    return seconds * stamps.NANOSECONDS + nanoseconds


def stamp_alone(stamp: int) -> bytes:
    """A serialized message that is nothing but a stamp, as /clock is."""
    return cdr.ENCAPSULATION + struct.pack("<iI", *divmod(stamp, stamps.NANOSECONDS))
