"""How long cyclic frames of fixed priority wait on a CAN bus: the longest time from release to arrival.

Davis, Burns, Bril, Lukkien (2007): Controller Area Network (CAN) schedulability analysis: refuted,
revisited and revised. Real-Time Systems 35, 239-272. No jitter of release.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import ceil
from typing import NamedTuple

from ev_msgs_py.can.database import FrameLayout
from ev_msgs_py.can.frame_length import longest_frame


class Cyclic(NamedTuple):
    """A frame with its period and its time on the bus, in any one unit of time."""

    cycle: float
    duration: float


def response_times(frames: Sequence[Cyclic], bit_time: float) -> list[float]:
    """The longest time until each frame has arrived; highest priority first. ValueError if the bus is overloaded."""
    if sum(frame.duration / frame.cycle for frame in frames) > 1.0:
        raise ValueError("the frames need more than the whole time of the bus")
    return [_response(frames, place, bit_time) for place in range(len(frames))]


def bus_load(frames: Iterable[FrameLayout], bit_rate: float) -> float:
    """Share of time that cyclic frames of the greatest length take [1]."""
    return sum(
        longest_frame(frame.length) / (bit_rate * frame.cycle)
        for frame in frames
        if frame.cycle > 0.0
    )


def of_layouts(layouts: Sequence[FrameLayout], bit_rate: float) -> dict[str, float]:
    """The longest response times [s] by name, for cyclic frames of the greatest length. ValueError as above."""
    ordered = sorted(
        (layout for layout in layouts if layout.cycle > 0.0), key=lambda layout: layout.identifier
    )
    frames = [Cyclic(layout.cycle, longest_frame(layout.length) / bit_rate) for layout in ordered]
    times = response_times(frames, 1.0 / bit_rate)
    return {layout.name: time for layout, time in zip(ordered, times, strict=True)}


def _response(frames: Sequence[Cyclic], place: int, bit_time: float) -> float:
    """Eqs 3 to 8: of all instances within the busy period at this priority, the one that waits longest."""
    frame, higher = frames[place], frames[:place]
    blocking = max((lower.duration for lower in frames[place + 1 :]), default=0.0)
    busy = _fixed_point(blocking + frame.duration, [*higher, frame], blocking, 0.0)
    longest = 0.0
    for instance in range(max(ceil(busy / frame.cycle - 1e-9), 1)):
        start = blocking + instance * frame.duration
        waits = _fixed_point(start, higher, start, bit_time)
        longest = max(longest, waits - instance * frame.cycle + frame.duration)
    return longest


def _fixed_point(guess: float, others: Sequence[Cyclic], fixed: float, ahead: float) -> float:
    while True:
        interference = sum(
            ceil((guess + ahead) / other.cycle - 1e-9) * other.duration for other in others
        )
        better = fixed + interference
        if better <= guess * (1.0 + 1e-12):
            return better
        guess = better
