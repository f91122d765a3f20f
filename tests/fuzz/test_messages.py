"""Bytes that come as messages.

Read whole and finite, or refused in a line, by nodes and recorder alike.
"""

from __future__ import annotations

import math
import random

from campaign.spoiling import HOW, spoilt
from fuzz.fuzzing import assert_one_line, fuzzed, seeds
from hypothesis import given
from hypothesis import strategies as st

from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.wire import MessageError, format_of, stamp_of
from ev_stack.recording.spool import MessageTable

signals = st.sampled_from([signal for signal, topic in TOPICS.items() if topic.channels])


@st.composite
def messages(draw: st.DrawFn) -> tuple[type, bytes]:
    """A signal, and bytes that say they are it."""
    signal = draw(signals)
    template = format_of(signal).template
    if draw(st.booleans()):
        return signal, draw(st.binary(max_size=2 * len(template)))
    chance = random.Random(draw(seeds))
    message = bytearray(template)
    for _ in range(chance.randrange(12)):
        message[chance.randrange(len(message))] = chance.randrange(256)
    how = draw(st.sampled_from((None, *HOW)))
    return signal, bytes(message) if how is None else spoilt(bytes(message), how, chance)


@fuzzed(40, 2.0)
@given(messages())
def test_what_is_no_message_is_refused_by_all_in_the_same_way(case):
    signal, message = case
    format_ = format_of(signal)
    refusals: list[MessageError] = []
    MessageTable(TOPICS[signal]).numbers([message], lambda place, error: refusals.append(error))
    try:
        stamp, numbers = format_.read(message)
    except MessageError as error:
        assert_one_line(error)
        assert len(refusals) == 1
        return
    assert not refusals
    assert stamp == stamp_of(message)
    assert len(numbers) == len(TOPICS[signal].channels)
    assert all(math.isfinite(number) for number in numbers)
