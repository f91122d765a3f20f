"""A channel of the bus without hardware: sending times, durations, lost frames.

The same in each run.

The waiting frame with the lowest identifier goes as soon as the bus is free; a frame on the wire is
not interrupted. Times are in bits, counted from the beginning of the present tick. A place holds
one frame that waits and the newest one that has arrived, as the message objects of a CAN controller
do: a frame that ends on the wire before the one in front of it was taken overwrites that, which
counts as lost.

It runs in each tick. Tables are records, no tuples: handing those over would cost compiled code as
much as a frame.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ev_bench.bus.parameters import BusInterface
from ev_core.parameters.declaration import parameter, setting
from ev_core.parameters.record import entry, series
from ev_core.sensors.random_numbers import WORD, philox, uniform
from ev_msgs_py.can.database import FrameLayout
from ev_msgs_py.can.frame_length import NEVER_STUFFED, header, longest_frame, wire_bits
from ev_msgs_py.can.frames import TICK
from ev_msgs_py.can.payload import NO_FRAME, joined
from ev_msgs_py.compilable import compilable
from ev_msgs_py.contract.optional_signals import MOST_TICKS

PLACES = 11  # frames of one circuit
SENT = 4  # numbers that are kept of each frame on the wire: place, end [bit], words
NO_PLACE = -1.0
_LONGEST = float(longest_frame(8))
_FASTEST = 1e6  # bit/s
_SHORTEST = 34 + NEVER_STUFFED  # bits of a frame without data and stuff bits
# frames that can begin in a control period
_MOST_SENT = int(MOST_TICKS * TICK * _FASTEST) // _SHORTEST + 1


@dataclass(frozen=True, slots=True)
class BusModelParameters(BusInterface):
    """The bus in lockstep; in real time its frames go over the interface."""

    bit_rate: float = parameter(
        1e6, unit="bit/s", low=1.25e5, high=_FASTEST, about="of both channels"
    )
    phase: float = parameter(
        0.0005, unit="s", low=0.0, high=0.0009, source="assumption: they are not synchronised",
        about="from the controller's cycle to that of the inverters",
    )  # fmt: skip
    loss: float = setting(
        0.0, unit="1", low=0.0, high=1.0, about="share of frames that are lost, by chance"
    )
    other_load: float = setting(
        0.0,
        unit="1",
        low=0.0,
        high=0.9,
        about="share of time that frames of others take, before all of ours",
    )
    seed: int = setting(
        0, low=0, high=2**31 - 1, about="of what is lost; goes with the seed of the node"
    )

    @property
    def is_random(self) -> bool:
        """Mark of a bus that depends on the seed."""
        return self.loss > 0.0


@dataclass(frozen=True, slots=True)
class ChannelFrames:
    """Header (`frame_length.Header`) and bytes of data by place, in the order of identifiers."""

    bits: list[float]
    state: list[float]
    crc: list[float]
    length: list[float]


@dataclass(slots=True)
class ChannelState:
    """State of the bus between two ticks."""

    pending: float = entry(unit="1", about="how many frames wait")
    waiting: list[float] = series(PLACES, unit="1", about="whether a frame waits")
    released: list[float] = series(PLACES, unit="bit", about="since when")
    low: list[float] = series(PLACES, unit="1", about="its words")
    high: list[float] = series(PLACES, unit="1")
    came: list[float] = series(
        PLACES, unit="1", about="whether a frame has arrived that was not taken yet"
    )
    came_low: list[float] = series(PLACES, unit="1", about="its words")
    came_high: list[float] = series(PLACES, unit="1")
    on_wire: float = entry(
        NO_PLACE, unit="1", about="place of the frame on the wire that will arrive; -1: none"
    )
    wire_low: float = entry(unit="1", about="its words")
    wire_high: float = entry(unit="1")
    free_from: float = entry(unit="bit", about="end of the frame on the wire")
    other_bits: float = entry(unit="bit", about="that others are still to send")
    count: float = entry(unit="1", about="frames sent since the start")
    lost: float = entry(
        unit="1", about="frames lost since the start: on the wire, or overtaken by the next one"
    )
    busy: float = entry(unit="bit", about="on the wire since the control period began")
    latency: float = entry(
        unit="bit", about="longest from release to arrival since the control period began"
    )
    tick_begin: float = entry(
        unit="bit", about="from the beginning of the control period to that of the tick"
    )
    sent_count: float = entry(unit="1", about="frames sent since the control period began")
    sent: list[float] = series(
        SENT * _MOST_SENT, unit="1", about="these frames; ends from its beginning on"
    )


def channel_frames(frames: Sequence[FrameLayout]) -> ChannelFrames:
    """The frames of a channel, in the order of their identifiers."""
    heads = [header(frame.identifier, frame.length) for frame in frames]
    lengths = [float(frame.length) for frame in frames]
    return ChannelFrames(
        [h.bits for h in heads], [h.state for h in heads], [h.crc for h in heads], lengths
    )


@compilable
def release(s: ChannelState, place: int, at: float, low: float, high: float) -> None:
    """Queue a frame from `at` [bit] on, in the place of an unsent one with its identifier."""
    # A place holds one frame: what has not been sent yet is overwritten, and lost.
    s.lost += s.waiting[place]
    s.pending += 1.0 - s.waiting[place]
    s.waiting[place], s.released[place] = 1.0, at
    s.low[place], s.high[place] = low, high


@compilable
def advance_channel(
    c: ChannelFrames, p: BusModelParameters, s: ChannelState, channel: int, until: float
) -> None:
    """Begin all frames that can begin before `until` [bit]; those that end until then arrive."""
    while s.free_from < until:
        _arrive(s)
        # Frames of others are of the longest kind, and have the lower identifiers.
        if s.other_bits >= _LONGEST:
            s.other_bits -= _LONGEST
            s.busy += _LONGEST
            s.free_from += _LONGEST
            continue
        if s.pending == 0.0:
            return
        now = _begin_of_next(s, until)
        if now >= until:
            return
        _send(c, p, s, channel, now)
    # A frame that ends just then has arrived.
    if s.free_from == until:
        _arrive(s)


@compilable
def _arrive(s: ChannelState) -> None:
    """End the frame on the wire; its receivers get it in the place of one that was not read."""
    if s.on_wire == NO_PLACE:
        return
    place = int(s.on_wire)
    s.lost += s.came[place]
    s.came[place], s.came_low[place], s.came_high[place] = 1.0, s.wire_low, s.wire_high
    s.on_wire = NO_PLACE


@compilable
def _begin_of_next(s: ChannelState, until: float) -> float:
    """When the next frame begins [bit]: as soon as the bus is free, if one waits then."""
    earliest = until
    for place in range(PLACES):
        if s.waiting[place] != 0.0:
            earliest = min(earliest, s.released[place])
            # One waits as soon as the bus is free; no later release can begin earlier.
            if earliest <= s.free_from:
                return s.free_from
    return earliest


@compilable
def _send(
    c: ChannelFrames, p: BusModelParameters, s: ChannelState, channel: int, now: float
) -> None:
    """The lowest identifier of those that wait goes on the wire."""
    place = 0
    while s.waiting[place] == 0.0 or s.released[place] > now:
        place += 1
    payload = joined(s.low[place], s.high[place])
    bits = wire_bits(c.bits[place], c.state[place], c.crc[place], payload, int(c.length[place]))
    s.waiting[place] = 0.0
    s.pending -= 1.0
    s.free_from = now + bits
    s.busy += bits
    s.count += 1.0
    _keep(s, place)
    if p.loss > 0.0 and _is_lost(p, s.count, channel):
        s.lost += 1.0
        return
    s.latency = max(s.latency, s.free_from - s.released[place])
    s.on_wire, s.wire_low, s.wire_high = float(place), s.low[place], s.high[place]


@compilable
def _keep(s: ChannelState, place: int) -> None:
    """Keep what is on the wire, for a log of the bus."""
    begin = SENT * int(s.sent_count)
    s.sent[begin], s.sent[begin + 1] = float(place), s.tick_begin + s.free_from
    s.sent[begin + 2], s.sent[begin + 3] = s.low[place], s.high[place]
    s.sent_count += 1.0


@compilable
def _is_lost(p: BusModelParameters, count: float, channel: int) -> bool:
    number = int(count)
    # By the number of the frame and not by a generator that goes on: what is lost does not depend
    # on what was drawn before.
    w0, w1, _, _ = philox(number & WORD, number >> 32, channel, 0, int(p.seed), 0)
    return uniform(w0, w1) < p.loss


@compilable
def take(s: ChannelState, place: int) -> tuple[float, float]:
    """Take the words of the newest frame that has arrived; NO_FRAME if there is none."""
    if s.came[place] == 0.0:
        return NO_FRAME, NO_FRAME
    s.came[place] = 0.0
    return s.came_low[place], s.came_high[place]


@compilable
def next_period(s: ChannelState) -> None:
    """Begin a control period, and with it what is counted in one."""
    s.busy = s.latency = s.tick_begin = s.sent_count = 0.0


@compilable
def next_tick(p: BusModelParameters, s: ChannelState) -> None:
    """Count from the beginning of the next tick on."""
    tick = bits_per_tick(p)
    # All times count from the new tick on; a bus that has been free for long is just free.
    s.free_from = max(s.free_from - tick, 0.0)
    s.tick_begin += tick
    s.other_bits += p.other_load * tick
    for i in range(PLACES):
        s.released[i] -= tick


@compilable
def bits_per_tick(p: BusModelParameters) -> float:
    """Number of bits in a tick."""
    return p.bit_rate * TICK
