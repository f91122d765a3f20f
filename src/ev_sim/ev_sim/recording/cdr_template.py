"""Many messages of one topic at once: serialized from rows of numbers, and back.

What the wire format does message by message, numpy does here for a whole run.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ev_msgs_py import stamps
from ev_msgs_py.topics import Topic
from ev_msgs_py.wire_format import STAMP_AT, wire_format


class CdrTemplate:
    """The serialized form of one topic's messages, with the places of stamp and numbers."""

    def __init__(self, topic: Topic) -> None:
        self._wire = wire_format(topic.signal)
        self._bytes = np.frombuffer(self._wire.template, np.uint8)
        self._number = np.dtype(f"<{self._wire.number}")
        self._constant = np.ones(len(self._bytes), bool)
        for place in self._wire.places:
            self._constant[place : place + self._number.itemsize] = False
        self._constant[STAMP_AT : STAMP_AT + 8] = False

    def serialize(self, stamps_ns: np.ndarray, rows: np.ndarray) -> list[bytes]:
        """Messages from their stamps (n,) in nanoseconds and numbers (n, channels)."""
        messages = np.tile(self._bytes, (len(rows), 1))
        seconds, nanoseconds = np.divmod(stamps_ns, stamps.NANOSECONDS)
        self._put(messages, STAMP_AT, seconds.astype("<i4"))
        self._put(messages, STAMP_AT + 4, nanoseconds.astype("<u4"))
        for place, column in zip(self._wire.places, rows.T, strict=True):
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
        rows = np.empty((len(messages), len(self._wire.places)))
        regular = [i for i, message in enumerate(messages) if len(message) == len(self._bytes)]
        table = np.frombuffer(b"".join(messages[i] for i in regular), np.uint8).reshape(-1, len(self._bytes))
        alike = (table[:, self._constant] == self._bytes[self._constant]).all(axis=1)
        columns = [
            np.ascontiguousarray(table[:, place : place + self._number.itemsize]).view(self._number)[:, 0]
            for place in self._wire.places
        ]
        if columns:
            rows[regular] = np.stack(columns, axis=1)
            alike &= np.isfinite(rows[regular]).all(axis=1)
        for i in sorted({*range(len(messages))} - {regular[j] for j in np.flatnonzero(alike)}):
            _, signal = self._wire.unpack(messages[i])
            rows[i] = self._wire.codec.shape.flat(signal)
        return rows
