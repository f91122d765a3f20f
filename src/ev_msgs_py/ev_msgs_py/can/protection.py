"""End-to-end protection of a payload by AUTOSAR E2E profile 1, variant 1A: what the sender adds.

Byte 0 is the checksum, the low half of byte 1 a counter from 0 to 14. The checksum is CRC-8 SAE J1850 with start value
and final XOR 0 (AUTOSAR PRS E2E protocol, profile 1), over the two bytes of the data id, low one first, and bytes 1 to
the last: a frame that is right but comes under another identifier is found too.
"""

from __future__ import annotations

from ev_msgs_py.can.codec import byte_of
from ev_msgs_py.can.crc8 import crc8_share
from ev_msgs_py.compiling.compilable import compilable, inlined

LONGEST = 8  # bytes of a classic frame
COUNTERS = 15  # values of the counter; 15 itself means that it is invalid


@compilable
def checksum(payload: int, length: int, data_id: int) -> int:
    """The checksum that belongs into byte 0 of a payload of `length` bytes."""
    if length == LONGEST:  # nearly all are so long, and the compiler unrolls a loop whose length it knows
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
    """The payload, whose guard bits are zero, with counter and checksum."""
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
