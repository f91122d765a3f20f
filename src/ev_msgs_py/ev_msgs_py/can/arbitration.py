"""Who sends when: of the frames that wait, the one with the lowest identifier, as soon as the bus is free."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from ev_msgs_py.can.frame_layout import FrameLayout
from ev_msgs_py.can.frame_length import longest_frame


class Waiting(NamedTuple):
    """A frame that a device wants to send."""

    since: float  # s
    identifier: int
    bits: int


def completions(frames: Sequence[Waiting], bit_rate: float, free_from: float = 0.0) -> list[float]:
    """When each frame has arrived [s], in the order of `frames`, on a bus that is busy until `free_from`.

    A frame that is on the bus is not interrupted. Equal identifiers go in the order of their times.
    """
    arrived = [0.0] * len(frames)
    left = sorted(range(len(frames)), key=lambda place: frames[place].since)
    now = free_from
    while left:
        now = max(now, frames[left[0]].since)
        waiting = [place for place in left if frames[place].since <= now]
        chosen = min(waiting, key=lambda place: (frames[place].identifier, frames[place].since))
        now += frames[chosen].bits / bit_rate
        arrived[chosen] = now
        left.remove(chosen)
    return arrived


def bus_load(frames: Iterable[FrameLayout], bit_rate: float) -> float:
    """Share of time that cyclic frames of the greatest length take [1]."""
    load = 0.0
    for frame in frames:
        if frame.cycle > 0.0:
            load += longest_frame(frame.length) / (bit_rate * frame.cycle)
    return load
