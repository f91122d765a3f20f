"""Many messages of one topic at once: serialized from a stack of frames, and back.

What a message format does message by message, numpy does here for a whole run.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.frame import PLACES, SIZE
from ev_msgs_py.contract.topics import Topic
from ev_msgs_py.wire.layout import MessageError
from ev_msgs_py.wire.message_format import STAMP_AT, format_of


class MessageTable:
    """The serialized form of one topic's messages, with the places of stamp and numbers."""

    def __init__(self, topic: Topic) -> None:
        self._format = format_of(topic.signal)
        self._where = PLACES[topic.signal]
        self._bytes = np.frombuffer(self._format.template, np.uint8)
        self._number = np.dtype(f"<{self._format.code}")
        self._constant = np.ones(len(self._bytes), bool)
        self._constant[STAMP_AT : STAMP_AT + 8] = False
        for run in self._format.runs:
            self._constant[run.offset : run.offset + run.length * self._number.itemsize] = False

    def serialize(self, stamps_ns: np.ndarray, frames: np.ndarray) -> list[bytes]:
        """Messages from their stamps (n,) in nanoseconds and frames (n, frame size)."""
        messages = np.tile(self._bytes, (len(frames), 1))
        seconds, nanoseconds = np.divmod(stamps_ns, stamps.NANOSECONDS)
        self._put(messages, STAMP_AT, seconds.astype("<i4"))
        self._put(messages, STAMP_AT + 4, nanoseconds.astype("<u4"))
        for run in self._format.runs:
            numbers = frames[:, run.place : run.place + run.length].astype(self._number)
            self._put(messages, run.offset, np.ascontiguousarray(numbers))
        return [message.tobytes() for message in messages]

    @staticmethod
    def _put(messages: np.ndarray, place: int, numbers: np.ndarray) -> None:
        raw = numbers.view(np.uint8).reshape(len(messages), -1)
        messages[:, place : place + raw.shape[1]] = raw

    def read(self, messages: Sequence[bytes], frames: np.ndarray) -> None:
        """Put the numbers of messages into frames (n, frame size); MessageError if one of them is refused.

        Messages of another layout (joints in another order, say) are read one by one.
        """
        for i in self._read_regular(messages, frames):
            frames[i, self._where] = self._format.read(messages[i])[1]

    def check(self, messages: Sequence[bytes], refuse: Callable[[int, MessageError], None]) -> None:
        """Tell `refuse` of the messages that `read` would refuse, by their places."""
        for i in self._read_regular(messages, np.empty((len(messages), SIZE))):
            try:
                self._format.read(messages[i])
            except MessageError as error:
                refuse(i, error)

    def _read_regular(self, messages: Sequence[bytes], frames: np.ndarray) -> list[int]:
        """Put the numbers of messages of our own layout into frames; the indices of the others, in order."""
        regular = [i for i, message in enumerate(messages) if len(message) == len(self._bytes)]
        table = np.frombuffer(b"".join(messages[i] for i in regular), np.uint8).reshape(-1, len(self._bytes))
        alike = (table[:, self._constant] == self._bytes[self._constant]).all(axis=1)
        size = self._number.itemsize
        for run in self._format.runs:
            raw = np.ascontiguousarray(table[:, run.offset : run.offset + run.length * size])
            frames[regular, run.place : run.place + run.length] = raw.view(self._number)
        alike &= np.isfinite(frames[regular, self._where]).all(axis=1)
        return sorted({*range(len(messages))} - {regular[j] for j in np.flatnonzero(alike)})
