"""How many bits a classic CAN frame with an 11-bit identifier takes on the wire (ISO 11898-1)."""

from __future__ import annotations

from collections.abc import Iterator

_CRC_POLYNOMIAL = 0x4599
CRC_BITS = 15
_STUFFED_WITHOUT_DATA = 34  # start, identifier, RTR, IDE, r0, length, CRC
NEVER_STUFFED = 13  # CRC delimiter, ACK slot, ACK delimiter, 7 bits end of frame, 3 bits between frames
_EQUAL_BITS = 5  # after which a stuff bit of the other value follows


def longest_frame(length: int) -> int:
    """Bits of the longest frame with `length` bytes and the pause after it (Davis et al. 2007, eq 1): 135 with 8."""
    stuffed = _STUFFED_WITHOUT_DATA + 8 * length
    return stuffed + (stuffed - 1) // (_EQUAL_BITS - 1) + NEVER_STUFFED


def exact_frame(identifier: int, data: bytes) -> int:
    """Bits of this very frame, stuff bits counted, and the pause after it."""
    bits = list(frame_bits(identifier, data))
    return len(bits) + stuff_bits(bits) + NEVER_STUFFED


def frame_bits(identifier: int, data: bytes) -> Iterator[int]:
    """The bits that are stuffed, before that: from the start of the frame to the last of its CRC."""
    head = [0, *_bits(identifier, 11), 0, 0, 0, *_bits(len(data), 4)]
    body = [bit for byte in data for bit in _bits(byte, 8)]
    yield from head
    yield from body
    yield from _bits(crc15([*head, *body]), CRC_BITS)


def stuff_bits(bits: list[int]) -> int:
    """How many bits are stuffed in: one after five equal ones, which counts for the next five."""
    count = run = 0
    last = -1
    for bit in bits:
        run = run + 1 if bit == last else 1
        last = bit
        if run == _EQUAL_BITS:
            count += 1
            last, run = 1 - bit, 1
    return count


def crc15(bits: list[int]) -> int:
    """CRC-15 of CAN, polynomial 4599h, start value 0."""
    crc = 0
    for bit in bits:
        crc = (crc << 1) ^ (_CRC_POLYNOMIAL if bit ^ (crc >> (CRC_BITS - 1) & 1) else 0)
        crc &= (1 << CRC_BITS) - 1
    return crc


def _bits(number: int, count: int) -> list[int]:
    return [number >> place & 1 for place in reversed(range(count))]
