"""A payload of 64 bits as it goes between nodes: two words of 32 bits each, which a float64 holds exactly."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import compilable

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
