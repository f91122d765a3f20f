"""AUTOSAR E2E profile 1: what is sent, and what the receiver says to what comes."""

from __future__ import annotations

import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ev_bench.bus.checking import (
    INITIAL,
    NO_NEW_DATA,
    OK,
    OK_SOME_LOST,
    REPEATED,
    SYNC,
    TOLERANCES,
    WRONG_CRC,
    WRONG_SEQUENCE,
    CheckState,
    check,
    is_valid,
    no_new_data,
)
from ev_core.compiled.loop import compiled, one_record
from ev_core.parameters.record import numbers
from ev_msgs_py.can.payload import checksum, counter_of, next_counter, protected

LENGTH, DATA_ID = 8, 0x123


def frame(counter: int, content: int = 0) -> int:
    return protected(content, LENGTH, DATA_ID, counter)


def heard(s: CheckState, payload: int) -> int:
    return check(TOLERANCES, s, payload, LENGTH, DATA_ID)


def in_step(*counters: int) -> CheckState:
    """A receiver that has synchronised with these counters."""
    s = CheckState()
    for counter in counters:
        heard(s, frame(counter))
    return s


@pytest.mark.parametrize(
    ("counter", "expected"), [(0, "cc00000000000000"), (1, "9101000000000000")]
)
def test_published_frames(counter: int, expected: str):
    """AUTOSAR PRS E2E protocol, profile 1, data id 0123h in both bytes, all data zero."""
    assert frame(counter).to_bytes(8, "little").hex() == expected


def test_the_counter_runs_from_0_to_14():
    counters = [0]
    while len(counters) < 30:
        counters.append(next_counter(counters[-1]))
    assert counters == [*range(15), *range(15)]


def test_frames_in_sequence_are_ok_after_the_first_two():
    """The first tells where the counter stands."""
    s = CheckState()
    assert [heard(s, frame(c)) for c in (7, 8, 9, 10, 11, 12, 13, 14, 0, 1)] == [INITIAL] + [OK] * 9


def test_a_frame_that_comes_again_is_repeated():
    s = in_step(3, 4)
    assert heard(s, frame(4)) == REPEATED
    assert heard(s, frame(5)) == OK


@pytest.mark.parametrize("lost", [1, 2])
def test_a_few_lost_frames_are_tolerated_and_counted(lost: int):
    s = in_step(3, 4)
    assert heard(s, frame(5 + lost)) == OK_SOME_LOST
    assert s.lost_data == lost


def test_more_lost_frames_are_a_wrong_sequence_until_it_goes_on_rightly():
    """max_delta_counter is 3 after a right frame, then 4: a step of 5 is too large."""
    s = in_step(3, 4)
    assert heard(s, frame(9)) == WRONG_SEQUENCE
    assert [heard(s, frame(c)) for c in (10, 11)] == [SYNC, OK]


def test_silence_lets_the_tolerated_step_grow():
    s = in_step(3, 4)
    assert [no_new_data(s) for _ in range(3)] == [NO_NEW_DATA] * 3
    assert heard(s, frame(9)) == OK_SOME_LOST


def test_after_a_long_silence_it_synchronises_again():
    s = in_step(3, 4)
    for _ in range(10):
        no_new_data(s)
    assert [heard(s, frame(c)) for c in (5, 6, 7)] == [SYNC, SYNC, OK]


def test_any_wrong_bit_is_a_wrong_crc():
    for bit in range(64):
        s = in_step(3, 4)
        assert heard(s, frame(5) ^ (1 << bit)) == WRONG_CRC
        assert heard(s, frame(5)) == OK


def test_a_right_frame_of_another_identifier_is_a_wrong_crc():
    s = in_step(3, 4)
    assert heard(s, protected(0, LENGTH, DATA_ID + 1, 5)) == WRONG_CRC
    assert heard(s, protected(0, LENGTH, DATA_ID + 0x100, 5)) == WRONG_CRC


def test_counter_15_is_invalid_even_with_the_right_crc():
    s = in_step(13, 14)
    assert heard(s, frame(15)) == WRONG_CRC


def test_of_random_frames_one_in_256_has_the_right_crc_and_hardly_any_is_in_sequence():
    """20000 frames: 78 expected with a standard deviation of 9; within 5 of them."""
    numbers_, s, right, valid = random.Random(1), CheckState(), 0, 0
    for _ in range(20000):
        payload = numbers_.getrandbits(64)
        right += payload & 0xFF == checksum(payload, LENGTH, DATA_ID)
        valid += is_valid(heard(s, payload))
    assert 33 < right < 123
    assert valid < right


def test_compiled_code_says_the_same():
    """A long mixture of right, lost, repeated, wrong and missing frames."""
    compiled_check, compiled_silence, compiled_protect = (
        compiled(check),
        compiled(no_new_data),
        compiled(protected),
    )
    s, memory, numbers_, counter = CheckState(), one_record(CheckState())[0], random.Random(2), 0
    for _ in range(2000):
        event = numbers_.random()
        if event < 0.2:
            assert compiled_silence(memory) == no_new_data(s)
            continue
        counter = (counter + (1 if event < 0.8 else numbers_.randrange(15))) % 15
        content = numbers_.getrandbits(47) << 16
        payload = protected(content, LENGTH, DATA_ID, counter)
        assert compiled_protect(content, LENGTH, DATA_ID, counter) == payload
        if event > 0.9:
            payload ^= 1 << numbers_.randrange(63)
        assert compiled_check(TOLERANCES, memory, payload, LENGTH, DATA_ID) == heard(s, payload)
        assert list(memory.item()) == numbers(s)


def test_the_counter_is_where_the_protection_puts_it():
    assert [counter_of(frame(c)) for c in range(15)] == list(range(15))


def test_frames_with_a_wrong_crc_ask_for_no_synchronising():
    """Repeated frames and cycles without one do, after five of them.

    By the standard a damaged one is neither.
    """
    s = in_step(0, 1, 2)
    for counter in range(3, 10):
        assert heard(s, frame(counter) ^ 1) == WRONG_CRC
    assert heard(s, frame(10)) == OK_SOME_LOST


class Reference:
    """E2E_P01Check as the standard describes it, by its own names."""

    def __init__(self) -> None:
        self.wait, self.last, self.most, self.not_new, self.sync = True, 0, 0, 0, 0

    def status(self, counter: int | None, is_damaged: bool) -> int:
        """None: no new data."""
        self.most = min(self.most + 1, 14)
        if counter is None:
            self.not_new = min(self.not_new + 1, 14)
            return NO_NEW_DATA
        if is_damaged:
            return WRONG_CRC
        delta = (counter - self.last) % 15
        if not self.wait and delta == 0:
            self.not_new = min(self.not_new + 1, 14)
            return REPEATED
        in_sequence, first = delta <= self.most, self.wait
        self.wait, self.last, self.most = False, counter, 3
        if first:
            return INITIAL
        many, self.not_new = self.not_new > 5, 0
        if not in_sequence:
            self.sync = 1
            return WRONG_SEQUENCE
        if many:
            self.sync = 1
            return SYNC
        if self.sync > 0:
            self.sync -= 1
            return SYNC
        return OK if delta == 1 else OK_SOME_LOST


_CYCLES = st.lists(
    st.tuples(st.none() | st.integers(0, 14) | st.just(-1), st.booleans()), max_size=60
)


@given(_CYCLES)
@settings(max_examples=500, deadline=None)
def test_every_sequence_of_frames_is_judged_as_the_standard_has_it(cycles):
    """No frame, any counter, the next one, damaged or not."""
    s, reference, last = CheckState(), Reference(), 0
    for counter, is_damaged in cycles:
        counter = next_counter(last) if counter == -1 else counter
        if counter is None:
            found = no_new_data(s)
        else:
            found = heard(s, frame(counter) ^ (0x100000 if is_damaged else 0))
            last = counter
        assert found == reference.status(counter, is_damaged)
