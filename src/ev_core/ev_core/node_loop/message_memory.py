"""Messages in a block of memory, and the runs of their numbers to and from a frame: compiled `wire`."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ev_msgs_py.compilable import compilable
from ev_msgs_py.contract.stamps import NANOSECONDS
from ev_msgs_py.wire import STAMP_AT


class End(NamedTuple):
    """A subscription or a publisher: its address, and how its messages look, as in `MessageFormat`."""

    address: int
    format: Any


class Memory(NamedTuple):
    """One block as bytes and as numbers; messages stand in it so that their numbers are whole ones of the block."""

    bytes: Any
    words: Any  # integers of 8 bytes
    integers: Any  # of 4 bytes
    doubles: Any
    singles: Any


def integers(*names: str) -> list[Any]:
    """Fields of a record that are integers."""
    return [(name, np.int64) for name in names]


# A topic: `template` and `mask`, which has all bits of what is constant, begin at these bytes of the block, and the
# runs `first` to `last` have its numbers, which are `single` precision or not.
TOPIC = integers("template", "mask", "length", "first", "last", "single")
RUN = np.dtype(integers("place", "offset", "length"))


@compilable
def is_laid_out_like(memory: Any, at: int, topic: Any) -> bool:
    """Whether a message of the length of a topic's template has its constants."""
    differs = 0
    for n in range(topic.length):
        differs |= (memory.bytes[at + n] ^ memory.bytes[topic.template + n]) & memory.bytes[topic.mask + n]
    return differs == 0


@compilable
def stamp_in(memory: Any, at: int) -> int:
    """The stamp of a message [ns]."""
    place = (at + STAMP_AT) // 4
    stamp: int = int(memory.integers[place]) * NANOSECONDS + int(memory.integers[place + 1])
    return stamp


@compilable
def read_numbers(memory: Any, at: int, topic: Any, runs: Any, numbers: Any) -> bool:
    """Copy the numbers of a message into a frame, as long as they are finite; whether all are."""
    for r in range(topic.first, topic.last):
        place, begin = runs[r].place, at + runs[r].offset
        for n in range(runs[r].length):
            number = float(memory.singles[begin // 4 + n]) if topic.single else memory.doubles[begin // 8 + n]
            if number - number != 0.0:
                return False
            numbers[place + n] = number
    return True


@compilable
def write_message(memory: Any, topic: Any, runs: Any, stamp: int, numbers: Any) -> None:
    """Put stamp and numbers of a frame into the template of a topic."""
    at = (topic.template + STAMP_AT) // 4
    memory.integers[at], memory.integers[at + 1] = stamp // NANOSECONDS, stamp % NANOSECONDS
    for r in range(topic.first, topic.last):
        place, begin = runs[r].place, topic.template + runs[r].offset
        for n in range(runs[r].length):
            if topic.single:
                memory.singles[begin // 4 + n] = numbers[place + n]
            else:
                memory.doubles[begin // 8 + n] = numbers[place + n]
