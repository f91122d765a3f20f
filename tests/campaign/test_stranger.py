"""Every act of the campaign's stranger is declared and comes up.

Its messages can be built. No process and no graph is needed.
"""

from __future__ import annotations

import random

import pytest
from campaign.doings import DOINGS
from campaign.forgeries import FORGERIES, Heard, rtps
from campaign.kinds import kind_of, turn_of
from campaign.sayings import SAYINGS
from campaign.stranger import ACTS, CLASSES
from hypothesis import given
from hypothesis import strategies as st
from rclpy.serialization import serialize_message

from ev_msgs_py.contract.signals import WheelTorqueCommand
from ev_msgs_py.wire import format_of

HEARD = Heard(bytes(range(1, 17)), 5, format_of(WheelTorqueCommand).template)
_MOST = 60_000  # bytes of a datagram, so that one can be sent


def test_every_act_comes_up_within_1000_seeds():
    """Acts take turns, and no two have the same name."""
    strangers = [seed for seed in range(1, 1001) if kind_of(seed).name == "stranger"]
    assert {ACTS[turn_of(seed) % len(ACTS)] for seed in strangers} == set(ACTS)
    assert len(set(ACTS)) == len(SAYINGS) + len(DOINGS) + len(FORGERIES)


def test_turns_count_the_seeds_of_a_kind():
    for name in ("stranger", "kill"):
        turns = [turn_of(seed) for seed in range(300) if kind_of(seed).name == name]
        assert turns == list(range(len(turns)))


def test_every_act_says_what_it_is():
    assert all(act.about for act in (*SAYINGS.values(), *DOINGS.values(), *FORGERIES.values()))


@pytest.mark.parametrize("name", SAYINGS)
def test_what_is_said_is_a_message(name):
    """One that rclpy serializes, or bytes that begin as one does."""
    messages = list(SAYINGS[name].say(random.Random(1), 10**9))
    assert messages
    for topic, kind, message in messages:
        assert topic
        if not isinstance(message, bytes):
            assert isinstance(message, kind)
            message = serialize_message(message)
        assert len(message) >= 4


@pytest.mark.parametrize("name", FORGERIES)
@given(seed=st.integers(0, 2**32 - 1))
def test_what_is_forged_is_a_datagram_in_the_name_of_a_process(name, seed):
    """Datagrams can be sent; all but noise and what is cut off have a whole header."""
    forgery = FORGERIES[name]
    datagrams = list(forgery.forge(random.Random(seed), HEARD))
    assert forgery.topic in CLASSES
    assert datagrams
    assert all(len(datagram) <= _MOST for datagram in datagrams)
    assert name in ("noise", "cut off") or all(
        each.startswith(rtps(HEARD.gid)[:19]) for each in datagrams
    )
