"""Frame: all signals of one instant in one row of float64.

The first number is the time. Then come the signals in the order in which their roles stand in
`roles.ROLES`, those of optional roles last, field by field, wheel by wheel: the order that messages
and recordings have as well.
"""

from __future__ import annotations

import ctypes
import struct
from array import array
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from itertools import accumulate
from types import MappingProxyType

import numpy as np

from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.fields import shape_of
from ev_msgs_py.contract.roles import RECORDED
from ev_msgs_py.contract.topics import TOPICS

_DOUBLE = 8  # bytes of a number

TIME = 0  # place of the time [s]

_ENDS = tuple(accumulate((shape_of(signal).size for signal in RECORDED), initial=1))

# Where the numbers of a signal stand in the frame.
PLACES = {
    signal: slice(begin, end)
    for signal, begin, end in zip(RECORDED, _ENDS, _ENDS[1:], strict=False)
}
SIZE = _ENDS[-1]
_EMPTY = array("d", bytes(SIZE * _DOUBLE))
_TIME = struct.Struct("d")


def places(signal: type) -> range:
    """Places of the numbers of a signal, one by one."""
    return range(PLACES[signal].start, PLACES[signal].stop)


def span(signals: Iterable[type]) -> tuple[int, int]:
    """Begin of the first of some signals in the frame, and end of the last one."""
    found = [PLACES[signal] for signal in signals]
    return min(place.start for place in found), max(place.stop for place in found)


def _unsigned_commands() -> frozenset[int]:
    """Places of commands that are never negative, such as brake torques."""
    found: set[int] = set()
    for signal, place in PLACES.items():
        found.update(place.start + i for i in shape_of(signal).unsigned_commands)
    return frozenset(found)


UNSIGNED_COMMANDS = _unsigned_commands()


@cache
def channels() -> Mapping[str, int]:
    """Place in the frame of every recorded channel, such as wheel_states.velocity.front_left."""
    found: dict[str, int] = {}
    for signal in PLACES:
        found.update(zip(TOPICS[signal].channels, places(signal), strict=True))
    return MappingProxyType(found)


def units() -> dict[str, str]:
    """Unit of every recorded channel."""
    found: dict[str, str] = {}
    for signal in PLACES:
        found.update(zip(TOPICS[signal].channels, shape_of(signal).units, strict=True))
    return found


def times(instants: int, period: int) -> np.ndarray:
    """So many instants from time zero [s], `period` nanoseconds apart."""
    return np.arange(instants) * period / stamps.NANOSECONDS


def stack(instants: int, period: int) -> np.ndarray:
    """Empty frames from time zero, `period` nanoseconds apart: (instants, size)."""
    frames = np.zeros((instants, SIZE))
    frames[:, TIME] = times(instants, period)
    return frames


class Frame:
    """Frame in memory: `numbers` is a view of it, compiled code finds it at `address`."""

    __slots__ = ("address", "numbers")

    def __init__(self) -> None:
        memory = _EMPTY[:]
        self.numbers: memoryview[float] = memoryview(memory)
        self.address: int = memory.buffer_info()[0]

    @classmethod
    def of(cls, row: np.ndarray) -> Frame:
        """Frame on a row of numbers of others, (size,), which lasts as long as the frame."""
        found = cls.__new__(cls)
        found.address, found.numbers = row.ctypes.data, memoryview(row)  # type: ignore[arg-type]  # mypy knows no buffer of numpy
        return found

    @classmethod
    def at(cls, address: int) -> Frame:
        """The frame that stands at an address."""
        found = cls.__new__(cls)
        found.address = address
        found.numbers = (
            memoryview((ctypes.c_char * (SIZE * _DOUBLE)).from_address(address)).cast("B").cast("d")
        )
        return found

    def copy(self, other: Frame, where: slice) -> None:
        """Take numbers over from another frame."""
        self.numbers[where] = other.numbers[where]


def numbers_of(values: Sequence[float]) -> array[float]:
    """Numbers in the form that a part of a frame can be set to."""
    return array("d", values)


def time_in(numbers: memoryview[float]) -> float:
    """The time [s] in the numbers of a frame."""
    time: float = _TIME.unpack_from(numbers, TIME * _DOUBLE)[0]
    return time
