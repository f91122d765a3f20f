"""Many messages of one topic at once: serialized from rows of numbers, and back.

The messages of a topic differ only in stamp and numbers, which sit at fixed places of the serialized form. With these
places found once, numpy does for a whole run what the middleware would do message by message, fifty times as fast.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from rclpy.serialization import deserialize_message, serialize_message

from ev_msgs_py import stamps
from ev_msgs_py.message_classes import message_class
from ev_msgs_py.topics import Topic

_STAMP_AT = 4  # behind the encapsulation header; every message of the contract begins with its stamp
_PROBE = 12345.5  # exact in single precision, and no other part of a message looks like it


class CdrTemplate:
    """The serialized form of one topic's messages, with the places of stamp and numbers."""

    def __init__(self, topic: Topic) -> None:
        self._codec = topic.codec
        self._class = message_class(topic.codec.message_type)
        message = topic.codec.prepare(self._class())
        header = getattr(message, "header", message)
        header.frame_id = topic.frame
        probe = np.array([_PROBE + i for i in range(len(topic.channels))])
        topic.codec.encode(topic.codec.shape.signal_of(tuple(probe)), message)
        self._bytes = np.frombuffer(serialize_message(message), np.uint8)
        self._number = self._find_number_type(probe)
        self._places = [self._bytes.tobytes().index(number.tobytes()) for number in probe.astype(self._number)]
        varying = [(place, self._number.itemsize) for place in self._places] + [(_STAMP_AT, 8)]
        self._constant = np.ones(len(self._bytes), bool)
        for place, size in varying:
            self._constant[place : place + size] = False

    def _find_number_type(self, probe: np.ndarray) -> np.dtype:
        double = np.dtype("<f8")
        found = len(probe) == 0 or probe[:1].astype(double).tobytes() in self._bytes.tobytes()
        return double if found else np.dtype("<f4")

    def serialize(self, stamps_ns: np.ndarray, rows: np.ndarray) -> list[bytes]:
        """Messages from their stamps (n,) in nanoseconds and numbers (n, channels)."""
        messages = np.tile(self._bytes, (len(rows), 1))
        seconds, nanoseconds = np.divmod(stamps_ns, stamps.NANOSECONDS)
        self._put(messages, _STAMP_AT, seconds.astype("<i4"))
        self._put(messages, _STAMP_AT + 4, nanoseconds.astype("<u4"))
        for place, column in zip(self._places, rows.T, strict=True):
            self._put(messages, place, column.astype(self._number))
        return [message.tobytes() for message in messages]

    @staticmethod
    def _put(messages: np.ndarray, place: int, column: np.ndarray) -> None:
        size = column.dtype.itemsize
        messages[:, place : place + size] = column.view(np.uint8).reshape(-1, size)

    def numbers(self, messages: Sequence[bytes]) -> np.ndarray:
        """Numbers (n, channels) of serialized messages; MessageError if one of them is refused.

        Messages of another layout (another sender's frame name, joints in another order) are read one by one.
        """
        rows = np.empty((len(messages), len(self._places)))
        regular = [i for i, message in enumerate(messages) if len(message) == len(self._bytes)]
        table = np.frombuffer(b"".join(messages[i] for i in regular), np.uint8).reshape(-1, len(self._bytes))
        alike = (table[:, self._constant] == self._bytes[self._constant]).all(axis=1)
        columns = [
            np.ascontiguousarray(table[:, place : place + self._number.itemsize]).view(self._number)[:, 0]
            for place in self._places
        ]
        if columns:
            rows[regular] = np.stack(columns, axis=1)
        for i in {*range(len(messages))} - {regular[j] for j in np.flatnonzero(alike)}:
            signal = self._codec.decode(deserialize_message(messages[i], self._class))
            rows[i] = self._codec.shape.flat(signal)
        return rows


def stamp_of(message: bytes) -> int:
    """The stamp in a serialized message of the contract, in nanoseconds."""
    seconds = int.from_bytes(message[_STAMP_AT : _STAMP_AT + 4], "little", signed=True)
    return seconds * stamps.NANOSECONDS + int.from_bytes(message[_STAMP_AT + 4 : _STAMP_AT + 8], "little")
