"""A channel without hardware: arbitration, loss, and the same bits compiled."""

from __future__ import annotations

import random

import pytest
from can_bus.databases import ours
from hypothesis import given, settings
from hypothesis import strategies as st

from documentation.response_times import of_layouts
from ev_bench.bus.model import (
    PLACES,
    SENT,
    BusModelParameters,
    ChannelState,
    advance_channel,
    bits_per_tick,
    channel_frames,
    next_period,
    next_tick,
    release,
    take,
)
from ev_core.compiled.loop import compiled, one_record
from ev_core.parameters.declaration import number_tree
from ev_core.parameters.record import numbers
from ev_msgs_py.can.frame_length import wire_bits
from ev_msgs_py.can.payload import NO_FRAME, joined, words

LAYOUTS = sorted(
    (f for f in ours() if "11" in f.name or "Ecu" in f.name), key=lambda f: f.identifier
)
FRAMES = channel_frames(LAYOUTS)
TICK = 1000.0  # bits
LONGEST = 135.0  # bits of a frame of others
PAYLOAD = (1.0, 2.0)  # words
BITS = [
    wire_bits(*head, joined(*PAYLOAD), int(length))
    for *head, length in zip(FRAMES.bits, FRAMES.state, FRAMES.crc, FRAMES.length, strict=True)
]  # of a frame with these words in each place


def advanced(s: ChannelState, until: float, **values: float) -> ChannelState:
    advance_channel(FRAMES, BusModelParameters(**values), s, 0, until)
    return s


def waiting(*frames: tuple[int, float]) -> ChannelState:
    """Frames by place and since when."""
    s = ChannelState()
    for place, at in frames:
        release(s, place, at, *PAYLOAD)
    return s


def ends(s: ChannelState) -> dict[int, float]:
    """Return by place the end of the newest frame on the wire [bit]."""
    rows = [s.sent[n : n + SENT] for n in range(0, SENT * int(s.sent_count), SENT)]
    return {int(place): end - s.tick_begin for place, end, *_ in rows}


def test_the_lowest_identifier_goes_first_but_interrupts_no_frame():
    """The third begins alone, the first and the second come meanwhile."""
    s = advanced(waiting((2, 0.0), (1, 50.0), (0, 60.0)), TICK)
    assert ends(s) == {0: BITS[2] + BITS[0], 1: sum(BITS[:3]), 2: BITS[2]}
    assert s.busy == sum(BITS[:3])
    assert s.latency == sum(BITS[:3]) - 50.0


def test_a_busy_bus_delays_everybody():
    s = waiting((0, 0.0))
    s.free_from = 40.0
    assert ends(advanced(s, TICK)) == {0: 40.0 + BITS[0]}


def test_what_has_not_arrived_yet_is_taken_in_a_later_tick():
    s = advanced(waiting((0, 950.0)), TICK)
    assert take(s, 0) == (NO_FRAME, NO_FRAME)
    next_tick(BusModelParameters(), s)
    assert s.free_from == BITS[0] - 50.0
    assert take(advanced(s, BITS[0] - 51.0), 0) == (NO_FRAME, NO_FRAME)
    assert take(advanced(s, BITS[0] - 50.0), 0) == PAYLOAD
    assert take(s, 0) == (NO_FRAME, NO_FRAME)


def test_what_has_arrived_waits_until_it_is_taken_though_the_next_one_is_on_its_way():
    """A frame that came at 600 bits is read a tick later, while the next one is on the wire.

    The next one takes its place at its end, not at its begin: else a bus with 40 % of other traffic
    would pass no set-point.
    """
    s, heard = ChannelState(), []
    for tick in range(4):
        release(s, 0, 600.0 - BITS[0], float(tick), 0.0)
        heard.append(take(advanced(s, 500.0), 0)[0])
        advanced(s, TICK)
        next_tick(BusModelParameters(), s)
    assert heard == [NO_FRAME, 0.0, 1.0, 2.0]
    assert s.lost == 0.0


def test_of_two_that_have_arrived_the_newest_is_there_and_the_other_one_is_counted():
    s = advanced(waiting((0, 0.0)), TICK)
    release(s, 0, 500.0, 7.0, 8.0)
    assert take(advanced(s, TICK), 0) == (7.0, 8.0)
    assert s.lost == 1.0


def test_the_load_of_others_comes_before_ours():
    """30 % of a tick are two frames of 135 bits."""
    s = waiting((0, 0.0))
    s.other_bits = 300.0
    assert ends(advanced(s, TICK, other_load=0.3)) == {0: 2 * LONGEST + BITS[0]}


def test_arbitration_never_takes_longer_than_the_analysis_says():
    """All frames of one circuit at random phases over 50 ticks."""
    bounds, chance, s = of_layouts(LAYOUTS, 1e6), random.Random(3), ChannelState()
    phases = [chance.uniform(0.0, TICK) for _ in LAYOUTS]
    longest = [0.0] * PLACES
    for tick in range(50):
        for place, layout in enumerate(LAYOUTS):
            if tick % round(layout.cycle * 1e3) == place % round(layout.cycle * 1e3):
                release(s, place, phases[place], *PAYLOAD)
        advanced(s, TICK)
        for place, end in ends(s).items():
            if not s.waiting[place]:
                longest[place] = max(longest[place], end - s.released[place])
        for place in range(PLACES):
            take(s, place)
        next_period(s)
        next_tick(BusModelParameters(), s)
    for place, layout in enumerate(LAYOUTS):
        assert 0.0 < longest[place] <= 1e6 * bounds[layout.name] + 1e-6
    assert s.lost == 0.0


@pytest.mark.parametrize("seed", [1, 2])
def test_what_is_lost_hangs_on_the_seed_alone(seed: int):
    """A tenth of 1000 frames, to four standard deviations of 9.5; and the same ones again."""

    def missing() -> list[int]:
        s, found = ChannelState(), []
        for tick in range(1000):
            release(s, 0, 0.0, *PAYLOAD)
            advanced(s, TICK, loss=0.1, seed=seed)
            if take(s, 0)[0] == NO_FRAME:
                found.append(tick)
            next_tick(BusModelParameters(), s)
            next_period(s)
        return found

    once = missing()
    assert once == missing()
    assert len(once) == pytest.approx(100, abs=38)


def test_compiled_code_gives_the_same_bits():
    p = BusModelParameters(loss=0.05, other_load=0.2, seed=7)
    s, memory, tree = ChannelState(), one_record(ChannelState())[0], one_record(number_tree(p))[0]
    put, go, shift, restart = map(compiled, (release, advance_channel, next_tick, next_period))
    chance, frames = random.Random(5), one_record(FRAMES)[0]
    for _ in range(100):
        for place in range(PLACES):
            if chance.random() < 0.6:
                frame = (place, float(chance.randrange(900)), *words(chance.getrandbits(64)))
                release(s, *frame)
                put(memory, *frame)
        advance_channel(FRAMES, p, s, 1, bits_per_tick(p))
        go(frames, tree, memory, 1, TICK)
        next_tick(p, s)
        shift(tree, memory)
        next_period(s)
        restart(memory)
        assert memory.reshape(1).view(float).tolist() == numbers(s)
    assert s.lost > 0.0


ACTS = st.lists(
    st.tuples(
        st.sampled_from(["release", "take"]), st.integers(0, PLACES - 1), st.integers(0, 999)
    ),
    max_size=30,
)


@settings(max_examples=50, derandomize=True, deadline=None)
@given(st.lists(ACTS, min_size=1, max_size=8), st.floats(0.0, 0.9), st.sampled_from([0.0, 0.3]))
def test_no_frame_is_lost_uncounted(ticks, other_load, loss):
    """Every released frame is taken, counted as lost, or still somewhere.

    Each place gives its frames in order.
    """
    s, p = ChannelState(), BusModelParameters(other_load=other_load, loss=loss)
    released, taken = 0, [[0.0] for _ in range(PLACES)]
    for acts in ticks:
        for act, place, at in sorted(acts, key=lambda each: each[2]):
            advance_channel(FRAMES, p, s, 0, float(at))
            if act == "release":
                released += 1
                release(s, place, float(at), float(released), 0.0)
            elif (low := take(s, place)[0]) != NO_FRAME:
                taken[place].append(low)
        advance_channel(FRAMES, p, s, 0, TICK)
        next_tick(p, s)
        next_period(s)
    under_way = sum(s.waiting) + sum(s.came) + (s.on_wire >= 0.0)
    assert released == sum(len(each) - 1 for each in taken) + s.lost + under_way
    assert all(each == sorted(set(each)) for each in taken)
