"""A payload of 64 bits: its two words, the signals in it, and its end-to-end protection.

A payload is one whole number, byte 0 in its lowest 8 bits, so that a signal in Intel order is a
shift and a mask: a physical value as a whole number of steps in some of its bits.

The protection is AUTOSAR E2E profile 1, variant 1A. Byte 0 is the checksum, the low half of byte 1
a counter from 0 to 14. The checksum is CRC-8 SAE J1850 with start value and final XOR 0 (AUTOSAR
PRS E2E protocol, profile 1), over the two bytes of the data id, low one first, and bytes 1 to the
last: a frame that is right but comes under another identifier is found too.
"""

from dataclasses import dataclass
from math import floor

from ev_msgs_py.compilable import compilable, inlined

NO_FRAME = -1.0  # in the place of a word
_WORD = 0xFFFFFFFF
_SHARE = 1e-6  # of a step, by which a limit may miss it: 7500 rpm in rad/s and back is 7500 rpm
POLYNOMIAL = 0x1D
_LONGEST = 10  # bytes: data id and data of a classic frame
LONGEST = 8  # bytes of a classic frame
COUNTERS = 15  # values of the counter; 15 itself means that it is invalid


@compilable
def words(payload: int) -> tuple[float, float]:
    """The low and the high 32 bits of a payload."""
    return float(payload & _WORD), float((payload >> 32) & _WORD)


@compilable
def joined(low: float, high: float) -> int:
    """The payload with these words."""
    return int(low) | (int(high) << 32)


@compilable
def are_words(low: float, high: float) -> bool:
    """Return true if these are the words of a frame, and not NO_FRAME or anything else."""
    return 0.0 <= low <= _WORD and 0.0 <= high <= _WORD


@dataclass(frozen=True, slots=True)
class BitField:
    """Place of a signal and meaning of its numbers: value = offset + scale * raw."""

    start: float  # lowest bit, counted from the lowest of byte 0
    length: float  # in bits, at most 32
    signed: float  # 1: two's complement
    scale: float  # unit of the signal, above zero
    steps: float  # per unit of the signal, 1/scale
    offset: float  # unit of the signal
    low: float  # unit of the signal
    high: float  # unit of the signal


@compilable
def raw_number(field: BitField, value: float) -> int:
    """Nearest whole number of steps, which saturates at the ends of its range."""
    limited = min(max(value, field.low), field.high)
    return floor((limited - field.offset) * field.steps + 0.5)


@compilable
def rounded_down(field: BitField, limit: float) -> float:
    """The largest value of a signal that is not above a limit: what is sent keeps the limit."""
    limited = min(max(limit, field.low), field.high)
    return field.offset + field.scale * floor((limited - field.offset) * field.steps + _SHARE)


@compilable
def inserted(payload: int, field: BitField, value: float) -> int:
    """The payload with the signal in its bits, which were zero."""
    mask = (1 << int(field.length)) - 1
    return payload | ((raw_number(field, value) & mask) << int(field.start))


@compilable
def extracted(payload: int, field: BitField) -> float:
    """The value of the signal in a payload."""
    length = int(field.length)
    raw = (payload >> int(field.start)) & ((1 << length) - 1)
    if field.signed != 0.0 and raw >= 1 << (length - 1):
        raw -= 1 << length
    return field.offset + field.scale * raw


@compilable
def byte_of(payload: int, place: int) -> int:
    """A byte of a payload, 0 to 255."""
    return (payload >> (8 * place)) & 0xFF


def _divided(byte: int) -> int:
    for _ in range(8):
        byte = (byte << 1) ^ (POLYNOMIAL if byte & 0x80 else 0)
    return byte & 0xFF


def _remainders() -> bytes:
    """Parts of the CRC, which is linear, by the number of bytes behind a byte and by the byte."""
    first = [_divided(byte) for byte in range(256)]
    found = [first]
    for _ in range(_LONGEST - 1):
        found.append([first[crc] for crc in found[-1]])
    return b"".join(map(bytes, found))


# As bytes, which compiled code reads in one instruction.
_REMAINDERS = _remainders()


@compilable
def crc8_share(byte: int, behind: int) -> int:
    """Part of the CRC, by exclusive or, of a byte with so many bytes behind it."""
    return int(_REMAINDERS[(behind & 15) << 8 | byte])


@compilable
def checksum(payload: int, length: int, data_id: int) -> int:
    """The checksum that belongs into byte 0 of a payload of `length` bytes."""
    if length == LONGEST:  # nearly all are so long, and the compiler unrolls a loop of known length
        return _checksum(payload, LONGEST, data_id)
    return _checksum(payload, length, data_id)


@inlined
def _checksum(payload: int, length: int, data_id: int) -> int:
    crc = crc8_share(data_id & 0xFF, length) ^ crc8_share((data_id >> 8) & 0xFF, length - 1)
    for place in range(1, length):
        crc ^= crc8_share(byte_of(payload, place), length - 1 - place)
    return crc


@compilable
def protected(payload: int, length: int, data_id: int, counter: int) -> int:
    """Payload with counter and checksum in its guard bits, which were zero."""
    counted = payload | (counter << 8)
    return counted | checksum(counted, length, data_id)


@compilable
def counter_of(payload: int) -> int:
    """The counter of a payload, 0 to 14 if it is valid."""
    return (payload >> 8) & 0xF


@compilable
def last_counter(counter: int) -> int:
    """The counter of the frame before."""
    return (counter - 1) % COUNTERS


@compilable
def next_counter(counter: int) -> int:
    """The counter of the next frame."""
    return (counter + 1) % COUNTERS
