"""A payload of 64 bits: its two words of 32 bits, and one signal in it.

One signal in the payload of a frame: a physical value as a whole number of steps in some of its bits.
A payload is one whole number, byte 0 in its lowest 8 bits, so that a signal in Intel order is a shift and a mask.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import floor

from ev_msgs_py.compilable import compilable

NO_FRAME = -1.0  # in the place of a word
_WORD = 0xFFFFFFFF


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
    """Whether these are the words of a frame, and not NO_FRAME or anything else."""
    return 0.0 <= low <= _WORD and 0.0 <= high <= _WORD


@dataclass(frozen=True, slots=True)
class BitField:
    """Where a signal stands and what its numbers mean: value = offset + scale * raw, from `low` to `high`."""

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
    """The whole number of steps nearest to a value, which saturates at the ends of its range like a transducer."""
    limited = min(max(value, field.low), field.high)
    return floor((limited - field.offset) * field.steps + 0.5)


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
def quantised(field: BitField, value: float) -> float:
    """The value that arrives when this one is sent."""
    return field.offset + field.scale * raw_number(field, value)


@compilable
def byte_of(payload: int, place: int) -> int:
    """A byte of a payload, 0 to 255."""
    return (payload >> (8 * place)) & 0xFF
