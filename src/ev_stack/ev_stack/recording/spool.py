"""Numbers that a recorder keeps of a run on the disk, so that its memory does not grow.

How it works: the messages that our nodes send on a topic have one length, so many of them are a
table of bytes, and a number is the same columns in each row: numpy reads and writes them all at
once. The recorder keeps the numbers of the last block of steps in memory and all before in a file.

Many messages of one topic at once: serialized from a stack of frames, and back.
What a message format does message by message, numpy does here for a whole run.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np

from ev_msgs_py.contract import frame, stamps
from ev_msgs_py.contract.frame import PLACES
from ev_msgs_py.contract.topics import Topic
from ev_msgs_py.wire import STAMP_AT, MessageError, format_of

BLOCK = 1024  # steps


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
        put_stamps(messages, STAMP_AT, stamps_ns)
        for run in self._format.runs:
            numbers = frames[:, run.place : run.place + run.length].astype(self._number)
            put(messages, run.offset, np.ascontiguousarray(numbers))
        return [message.tobytes() for message in messages]

    def read(self, messages: Sequence[bytes], frames: np.ndarray) -> None:
        """Put the numbers of messages into frames (n, frame size).

        Raises MessageError if one of them is refused.
        """

        def refuse(_place: int, error: MessageError) -> None:
            raise error

        frames[:, self._where] = self.numbers(messages, refuse)

    def numbers(
        self, messages: Sequence[bytes], refuse: Callable[[int, MessageError], None]
    ) -> np.ndarray:
        """The numbers of messages (n, channels).

        `refuse` is given place and reason of each that is refused.

        Messages of another layout (such as joints in another order) are read one by one.
        """
        found = np.zeros((len(messages), self._where.stop - self._where.start))
        regular = [i for i, message in enumerate(messages) if len(message) == len(self._bytes)]
        # All messages of the usual length as one table of bytes.
        table = np.frombuffer(b"".join(messages[i] for i in regular), np.uint8).reshape(
            -1, len(self._bytes)
        )
        # Where the fixed bytes differ the layout is another one, and the numbers are elsewhere.
        alike = (table[:, self._constant] == self._bytes[self._constant]).all(axis=1)
        size = self._number.itemsize
        for run in self._format.runs:
            raw = np.ascontiguousarray(table[:, run.offset : run.offset + run.length * size])
            begin = run.place - self._where.start
            found[regular, begin : begin + run.length] = raw.view(self._number)
        alike &= np.isfinite(found[regular]).all(axis=1)
        alike &= (found[regular][:, self._format.topic.shape.unsigned_commands] >= 0.0).all(axis=1)
        # All others go through the careful reader, which also gives the reason of a refusal.
        for i in sorted({*range(len(messages))} - {regular[j] for j in np.flatnonzero(alike)}):
            try:
                found[i] = self._format.read(messages[i])[1]
            except MessageError as error:
                refuse(i, error)
        return found


def put(messages: np.ndarray, place: int, numbers: np.ndarray) -> None:
    """Write numbers (n, ...), in one piece of memory, to a place in the bytes of each of n messages."""
    raw = numbers.view(np.uint8).reshape(len(messages), -1)
    messages[:, place : place + raw.shape[1]] = raw


def put_stamps(messages: np.ndarray, place: int, stamps_ns: np.ndarray) -> None:
    """Write stamps [ns] (n,)."""
    seconds, nanoseconds = np.divmod(stamps_ns, stamps.NANOSECONDS)
    put(messages, place, seconds.astype("<i4"))
    put(messages, place + 4, nanoseconds.astype("<u4"))


class Spool:
    """A nameless file with the numbers of a run in blocks of some steps; it ends with its process.

    Within a block each number of the frame has its place for all steps: a topic writes its own in
    one piece, and a channel is read in one piece per block. Unwritten parts take no room on the
    disk.
    """

    def __init__(self, folder: Path) -> None:
        self._file = tempfile.TemporaryFile(dir=folder, buffering=0)  # noqa: SIM115, closed with the recorder

    def write(self, block: int, first: int, numbers: np.ndarray) -> None:
        """Numbers (BLOCK, n) of the places from `first` on; OSError where the disk is full."""
        self._seek(block, first)
        left = memoryview(np.ascontiguousarray(numbers.T)).cast("B")
        # A write to an unbuffered file may take only a part.
        while left:
            left = left[self._file.write(left) :]

    def read(self, block: int, place: int, numbers: np.ndarray) -> None:
        """Fill numbers (BLOCK,) with those of a place."""
        self._seek(block, place)
        self._file.readinto(memoryview(numbers).cast("B"))

    def _seek(self, block: int, place: int) -> None:
        # Blocks of all places one behind the other; in each, BLOCK numbers for every place.
        self._file.seek((block * frame.SIZE + place) * BLOCK * np.dtype(float).itemsize)

    def clear(self) -> None:
        """Forget everything."""
        self._file.truncate(0)

    def close(self) -> None:
        """Give the room on the disk back."""
        self._file.close()


class SpooledTopic:
    """The numbers of one topic, step by step: the newest in memory, those before them in a spool.

    `count` is the number of steps, `first` and `last` are messages, empty as long as there is none.
    """

    def __init__(self, topic: Topic, spool: Spool) -> None:
        self._place = frame.PLACES[topic.signal]
        self._spool = spool
        self._newest = np.empty((BLOCK, self._place.stop - self._place.start))
        self.clear()

    def clear(self) -> None:
        """Forget everything."""
        self.count = self._spooled = 0
        self.first = self.last = b""

    def append(self, message: bytes, numbers: np.ndarray) -> None:
        """Keep the message of the next step and its numbers; OSError where the disk is full."""
        self.first = self.first or message
        self.last = message
        self._newest[self.count - self._spooled] = numbers
        self.count += 1
        if self.count == self._spooled + BLOCK:
            # A block at a time: the memory of a topic holds just one.
            self._spool.write(self._spooled // BLOCK, self._place.start, self._newest)
            self._spooled = self.count

    def hold(self, message: bytes, numbers: np.ndarray) -> None:
        """Repeat the last step, or take these where there is none."""
        self.append(
            self.last or message, self._newest[self.count % BLOCK - 1] if self.count else numbers
        )

    def series(self, steps: int) -> Iterator[np.ndarray]:
        """The numbers of so many steps (steps,), channel by channel.

        What has not come holds the last one.
        """
        spooled = self._spooled
        for channel, place in enumerate(range(self._place.start, self._place.stop)):
            numbers = np.empty(max(steps, self.count))
            for begin in range(0, spooled, BLOCK):
                self._spool.read(begin // BLOCK, place, numbers[begin : begin + BLOCK])
            numbers[spooled : self.count] = self._newest[: self.count - spooled, channel]
            # Where more steps are wanted than came, in real time.
            numbers[self.count :] = numbers[self.count - 1]
            yield numbers[:steps]
