"""What a recorder keeps of a run while it lasts: numbers on the disk, so that its memory does not grow.

Many messages of one topic at once: serialized from a stack of frames, and back.
What a message format does message by message, numpy does here for a whole run.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np

from ev_msgs_py.contract import frame, stamps
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
        self._constant = np.frombuffer(self._format.mask, np.uint8) != 0

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

        Messages of another layout (such as joints in another order) are read one by one.
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


BLOCK = 1024  # steps


class Spool:
    """A file without a name, gone with its process, in which the numbers of a run stand in blocks of some steps.

    Within a block each number of the frame has its place for all steps: a topic writes its own in one piece, and a
    channel is read in one piece per block. What nobody writes takes no room on the disk.
    """

    def __init__(self, folder: Path) -> None:
        self._file = tempfile.TemporaryFile(dir=folder, buffering=0)  # noqa: SIM115, closed with the recorder
        self.frames = np.empty((BLOCK, frame.SIZE))  # where a block of messages is read into

    def write(self, block: int, first: int, numbers: np.ndarray) -> None:
        """Numbers (BLOCK, n) of the places from `first` on; OSError where the disk is full."""
        self._seek(block, first)
        left = memoryview(np.ascontiguousarray(numbers.T)).cast("B")
        while left:
            left = left[self._file.write(left) :]

    def read(self, block: int, place: int, numbers: np.ndarray) -> None:
        """Fill numbers (BLOCK,) with those of a place."""
        self._seek(block, place)
        self._file.readinto(memoryview(numbers).cast("B"))

    def _seek(self, block: int, place: int) -> None:
        self._file.seek((block * frame.SIZE + place) * BLOCK * self.frames.itemsize)

    def clear(self) -> None:
        """Forget everything."""
        self._file.truncate(0)

    def close(self) -> None:
        """Give the room on the disk back."""
        self._file.close()


class SpooledTopic:
    """The messages of one topic, one per step: the newest as they came, those before them as numbers in a spool.

    `count` is their number, `first` and `last` are messages, empty as long as there is none.
    """

    def __init__(self, topic: Topic, spool: Spool) -> None:
        self._table = MessageTable(topic)
        self._place = frame.PLACES[topic.signal]
        self._spool = spool
        self.clear()

    def clear(self) -> None:
        """Forget all messages."""
        self.count = 0
        self.first = self.last = b""
        self._newest: list[bytes] = []

    def append(self, message: bytes) -> None:
        """Keep the message of the next step; OSError where the disk is full."""
        self.first = self.first or message
        self.last = message
        self.count += 1
        self._newest.append(message)
        if len(self._newest) == BLOCK:
            self._spool.write(self.count // BLOCK - 1, self._place.start, self._read_newest())
            self._newest.clear()

    def _read_newest(self) -> np.ndarray:
        frames = self._spool.frames[: len(self._newest)]
        self._table.read(self._newest, frames)
        return frames[:, self._place]

    def series(self, steps: int) -> Iterator[np.ndarray]:
        """The numbers of so many steps (steps,), channel by channel; what has not come holds the last one."""
        newest = self._read_newest().copy()
        spooled = self.count - len(newest)
        for channel, place in enumerate(range(self._place.start, self._place.stop)):
            numbers = np.empty(max(steps, self.count))
            for begin in range(0, spooled, BLOCK):
                self._spool.read(begin // BLOCK, place, numbers[begin : begin + BLOCK])
            numbers[spooled : self.count] = newest[:, channel]
            numbers[self.count :] = numbers[self.count - 1]
            yield numbers[:steps]
