"""The bits of one frame on the wire, counted one by one.

What the tables of `frame_length` are compared with.

Besides, the value that a signal has behind the bus.
"""

from __future__ import annotations

from ev_msgs_py.can.frame_length import NEVER_STUFFED, frame_bits
from ev_msgs_py.can.payload import BitField, raw_number
from ev_msgs_py.compilable import compilable

EQUAL_BITS = 5  # after which a stuff bit of the other value follows


def exact_frame(identifier: int, data: bytes) -> int:
    """Bits of this very frame, stuff bits counted, and the pause after it."""
    bits = list(frame_bits(identifier, data))
    return len(bits) + stuff_bits(bits) + NEVER_STUFFED


def stuff_bits(bits: list[int]) -> int:
    """Count the stuff bits: one after five equal ones, which counts for the next five."""
    count = run = 0
    last = -1
    for bit in bits:
        run = run + 1 if bit == last else 1
        last = bit
        if run == EQUAL_BITS:
            count += 1
            last, run = 1 - bit, 1
    return count


@compilable
def quantised(field: BitField, value: float) -> float:
    """The value that arrives when this one is sent."""
    return field.offset + field.scale * raw_number(field, value)
