"""Length on the wire of a classic CAN frame with an 11-bit identifier (ISO 11898-1).

How it works: the sender puts a bit of the other value behind five equal ones, so the length depends
on the data, and on the CRC behind them. Bits are counted a byte at a time, because this runs in
each cycle. Two tables of bytes do it: one has, by state of stuffing and byte, the stuff bits in
that byte and the next state; one has the part of the CRC of each byte at each place. A state of
stuffing is the value of the last bit and the number of equal ones so far, 1 to 4. All that comes
before the data is the same for all frames of an identifier, and counted once (`header`).
"""

from collections.abc import Iterable, Iterator
from itertools import chain
from typing import NamedTuple

from ev_msgs_py.can.payload import LONGEST
from ev_msgs_py.compilable import compilable, inlined

_CRC_POLYNOMIAL = 0x4599
CRC_BITS = 15
_STUFFED_WITHOUT_DATA = 34  # start, identifier, RTR, IDE, r0, length, CRC
# CRC delimiter, ACK slot, ACK delimiter, 7 bits end of frame, 3 bits between frames.
NEVER_STUFFED = 13
_EQUAL_BITS = 5  # after which a stuff bit of the other value follows
_STATES = 2 * (_EQUAL_BITS - 1)  # of stuffing, eight: three bits
_CRC_MASK = (1 << CRC_BITS) - 1


class Frame(NamedTuple):
    """A classic data frame with an 11-bit identifier."""

    identifier: int
    data: bytes


def longest_frame(length: int) -> int:
    """Bits of the longest frame of `length` bytes with its pause (Davis et al. 2007, eq 1)."""
    stuffed = _STUFFED_WITHOUT_DATA + 8 * length
    return stuffed + (stuffed - 1) // (_EQUAL_BITS - 1) + NEVER_STUFFED


def frame_bits(identifier: int, data: bytes) -> Iterator[int]:
    """Bits before stuffing, from the start of the frame to the last of its CRC."""
    head = [0, *_bits(identifier, 11), 0, 0, 0, *_bits(len(data), 4)]
    body = list(chain.from_iterable(_bits(byte, 8) for byte in data))
    yield from head
    yield from body
    yield from _bits(crc15([*head, *body]), CRC_BITS)


def crc15(bits: list[int]) -> int:
    """CRC-15 of CAN, polynomial 4599h, start value 0."""
    crc = 0
    for bit in bits:
        crc = (crc << 1) ^ (_CRC_POLYNOMIAL if bit ^ (crc >> (CRC_BITS - 1) & 1) else 0)
        crc &= (1 << CRC_BITS) - 1
    return crc


def _bits(number: int, count: int) -> list[int]:
    return [number >> place & 1 for place in reversed(range(count))]


class Header(NamedTuple):
    """Frame before its data: bits on the wire, state of stuffing, and CRC of zero data."""

    bits: float
    state: float
    crc: float


def _state(last: int, run: int) -> int:
    return (run - 1) * 2 + last


def _stuffed(state: int, bits: Iterable[int]) -> tuple[int, int]:
    """Stuff bits among these bits, and the state behind them."""
    last = state % 2
    run = state // 2 + 1
    count = 0
    for bit in bits:
        run = run + 1 if bit == last else 1
        last = bit
        if run == _EQUAL_BITS:  # a bit of the other value is stuffed, and begins a new run
            last = 1 - bit
            run = 1
            count += 1
    return count, _state(last, run)


def _remainders() -> list[int]:
    """Parts of the CRC, which is linear, by the number of bytes behind a byte and by the byte."""
    first = [crc15(_bits(byte, 8)) for byte in range(256)]
    found, last = [*first], first
    for _ in range(LONGEST - 1):
        last = [((crc << 8) & _CRC_MASK) ^ first[crc >> (CRC_BITS - 8)] for crc in last]
        found += last
    return found


def _stuffing() -> bytes:
    """Stuff bits times 8 plus the next state, by state and byte."""
    found = []
    for state in range(_STATES):
        for byte in range(256):
            count, then = _stuffed(state, _bits(byte, 8))
            found.append(count * _STATES + then)
    return bytes(found)


# As bytes, which compiled code reads in one instruction. Those of remainders are by the number of
# bytes behind a byte and by the byte, in two halves.
_STUFFING = _stuffing()
_LOW = bytes(crc & 0xFF for crc in _remainders())
_HIGH = bytes(crc >> 8 for crc in _remainders())


def header(identifier: int, length: int) -> Header:
    """The header of all frames with this identifier and so many bytes of data."""
    head = list(frame_bits(identifier, bytes(length)))[: -CRC_BITS - 8 * length]
    count, state = _stuffed(_state(head[0], 1), head[1:])
    crc = crc15([*head, *([0] * 8 * length)])
    return Header(float(len(head) + count), float(state), float(crc))


@compilable
def wire_bits(bits: float, state: float, crc: float, payload: int, length: int) -> float:
    """Bits on the wire of a frame with this header, stuff bits and the pause behind it counted."""
    if length == LONGEST:  # as in `payload.checksum`
        return _wire_bits(bits, state, crc, payload, LONGEST)
    return _wire_bits(bits, state, crc, payload, length)


@inlined
def _wire_bits(bits: float, state: float, crc: float, payload: int, length: int) -> float:
    now = int(state) & 7
    remainder = int(crc)
    count = 0
    for place in range(length):
        byte = (payload >> (8 * place)) & 0xFF
        behind = ((length - 1 - place) & 7) << 8 | byte
        remainder ^= int(_HIGH[behind]) << 8 | int(_LOW[behind])
        entry = int(_STUFFING[now << 8 | byte])
        count += entry >> 3
        now = entry & 7
    entry = int(_STUFFING[now << 8 | (remainder >> 7) & 0xFF])
    # One bit more than the CRC has, unlike its last one, so that it adds no stuff bit.
    rest = int(_STUFFING[(entry & 7) << 8 | (remainder & 0x7F) << 1 | (1 - (remainder & 1))])
    count += (entry >> 3) + (rest >> 3)
    return bits + float(8 * length + CRC_BITS + count + NEVER_STUFFED)
