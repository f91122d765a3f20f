"""What a recorder keeps of a run while it lasts: numbers on the disk, so that its memory does not grow."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from ev_msgs_py.contract import frame
from ev_msgs_py.contract.topics import Topic
from ev_sim.running.recording.message_table import MessageTable

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

    `count` says how many there are, `first` and `last` are messages, empty as long as there is none.
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
