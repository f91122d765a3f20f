"""Sums over what nodes take and send are those of the definition; changed numbers show."""

from __future__ import annotations

import hashlib
import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ev_core.lockstep.inbox import Inbox, Inputs, note_answer, row_of_answer
from ev_core.lockstep.tally import KEPT, READ, WRITTEN, Tally
from ev_msgs_py.contract.fields import shape_of
from ev_msgs_py.contract.frame import PLACES, SIZE, Frame
from ev_msgs_py.contract.signals import DriverCommand, WheelTorqueCommand
from ev_msgs_py.contract.stamps import RUN
from ev_msgs_py.contract.topics import TOPICS

KEY = b"a key"
PERIOD = 10_000_000
NUMBERS = st.floats(allow_nan=False, allow_infinity=False)
COMMAND = PLACES[WheelTorqueCommand]
WIDTH = COMMAND.stop - COMMAND.start
NAME = TOPICS[WheelTorqueCommand].name


def signed(number: int) -> int:
    """Modulo 2^64, as a number with sign."""
    return (number + 2**63) % 2**64 - 2**63


def by_definition(steps: list[list[float]]) -> int:
    """The sum over the steps of a topic in whole numbers of Python, which do not overflow."""
    keys = [
        key | 1
        for key in struct.unpack(
            f"<{2 + 2 * SIZE}q", hashlib.shake_256(KEY).digest(8 * (2 + 2 * SIZE))
        )
    ]
    total = 0
    for step, numbers in enumerate(steps):
        mixed = signed((step + 1) * keys[0])
        of_step = signed((mixed ^ (mixed >> 29)) * keys[1]) | 1
        for place, number in enumerate(numbers, COMMAND.start):
            low, high = struct.unpack("<Ii", struct.pack("<d", number))
            total += of_step * (keys[2 + 2 * place] * low + keys[3 + 2 * place] * high)
    return signed(total)


def tallied(steps: list[list[float]], written: bool = False, key: bytes = KEY) -> int:
    """The sum that a node has of a topic that it read, or wrote."""
    tally = Tally(key, (), (WheelTorqueCommand,)) if written else Tally(key, (WheelTorqueCommand,))
    for step, numbers in enumerate(steps):
        frame = Frame()
        frame.numbers[COMMAND] = memoryview(np.array(numbers))
        tally.add(step, frame.address, frame.address)
    last = len(steps) - 1
    found = tally.newest(last, last)[WRITTEN if written else READ][NAME]
    assert list(found) == [str(step) for step in range(max(last - KEPT + 1, 0), last + 1)]
    return found[str(last)]


STEPS = st.lists(st.lists(NUMBERS, min_size=WIDTH, max_size=WIDTH), min_size=1, max_size=9)


@settings(deadline=None)
@given(steps=STEPS)
def test_both_ends_have_the_sum_of_the_definition(steps):
    assert tallied(steps) == tallied(steps, written=True) == by_definition(steps)


@settings(deadline=None)
@given(steps=STEPS, data=st.data())
def test_changed_numbers_change_the_sum(steps, data):
    """Also where only signs are turned, numbers change places, or steps do.

    Zero and minus zero are two numbers.
    """
    others = [list(numbers) for numbers in steps]
    for _ in range(data.draw(st.integers(1, 3))):
        step, place = (
            data.draw(st.integers(0, len(steps) - 1)),
            data.draw(st.integers(0, WIDTH - 1)),
        )
        other_step, other_place = (
            data.draw(st.integers(0, len(steps) - 1)),
            data.draw(st.integers(0, WIDTH - 1)),
        )
        how = data.draw(st.sampled_from(["sign", "swap", "number"]))
        if how == "sign":
            others[step][place] = -others[step][place]
        elif how == "number":
            others[step][place] = data.draw(NUMBERS)
        else:
            here, there = others[step][place], others[other_step][other_place]
            others[step][place], others[other_step][other_place] = there, here
    same = np.array(steps).tobytes() == np.array(others).tobytes()
    assert (tallied(steps) == tallied(others)) == same


def test_a_node_that_integrates_outputs_the_step_ahead_of_its_inputs():
    """Its initial state is the output of step 0, so both ends of a topic have the same sum."""
    steps = [[float(step + 1)] * WIDTH for step in range(100)]
    tally = Tally(KEY, (), (WheelTorqueCommand,), ahead=1)
    for step, numbers in enumerate(steps):
        frame = Frame()
        frame.numbers[COMMAND] = memoryview(np.array(numbers))
        if step == 0:
            tally.begin(0, frame.address)
        else:
            tally.add(step - 1, frame.address, frame.address)
    assert tally.newest(-1, 99)[WRITTEN][NAME]["99"] == tallied(steps) == by_definition(steps)


@pytest.mark.parametrize("lead", [0, PERIOD], ids=["answers", "integrates"])
@pytest.mark.parametrize("run", [0, 3 * RUN])
def test_the_newest_step_of_an_inbox_is_added_where_it_stands(lead, run):
    """Over more steps than the inbox has rows, in a later run too, and of an output of the next instant."""
    inbox = Inbox(Inputs((DriverCommand,), PERIOD, lead=lead))
    at_once, one_by_one = (
        Tally(KEY, (DriverCommand,), (WheelTorqueCommand,), lead // PERIOD) for _ in range(2)
    )
    add = at_once.adder(inbox)
    for step in range(20):
        stamp = run + step * PERIOD
        inbox.offer(DriverCommand, stamp, [step + 0.1] * shape_of(DriverCommand).size)
        here = inbox.take(inbox.complete())
        there = inbox.frames[row_of_answer(inbox.steps, stamp + lead)]
        there.numbers[COMMAND] = memoryview(np.full(WIDTH, step + 0.2))
        note_answer(inbox.steps, stamp + lead)
        add()
        one_by_one.add(step, here.address, there.address)
    assert at_once.newest(19, 20) == one_by_one.newest(19, 20)
    assert at_once.newest(19, 20)[READ] != Tally(KEY, (DriverCommand,)).newest(19, 20)[READ]


def test_another_key_gives_another_sum():
    steps = [[1.0] * WIDTH]
    assert tallied(steps) != tallied(steps, key=b"another key")


def test_a_restarted_run_is_added_up_from_zero():
    tally, frame = Tally(KEY, (WheelTorqueCommand,)), Frame()
    frame.numbers[COMMAND] = memoryview(np.arange(1.0, 1.0 + WIDTH))
    for _ in range(2):
        tally.forget()
        tally.add(0, frame.address, frame.address)
        tally.add(1, frame.address, frame.address)
    assert tally.newest(1, -1)[READ][NAME]["1"] == by_definition(
        [list(np.arange(1.0, 1.0 + WIDTH))] * 2
    )
