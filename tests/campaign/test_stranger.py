"""Every act of the campaign's foreign process is declared and comes up, without a graph."""

from __future__ import annotations

import random

import pytest
from campaign.kinds import kind_of, turn_of
from campaign.stranger import ACTS, Publishing
from rclpy.serialization import serialize_message

PUBLISHING = [name for name, act in ACTS.items() if isinstance(act, Publishing)]


def test_every_act_comes_up_within_1000_seeds():
    """Acts take turns."""
    strangers = [seed for seed in range(1, 1001) if kind_of(seed).name == "stranger"]
    names = list(ACTS)
    assert {names[turn_of(seed) % len(names)] for seed in strangers} == set(ACTS)


def test_turns_count_the_seeds_of_a_kind():
    for name in ("stranger", "kill"):
        turns = [turn_of(seed) for seed in range(300) if kind_of(seed).name == name]
        assert turns == list(range(len(turns)))


@pytest.mark.parametrize("name", PUBLISHING)
def test_what_is_published_is_a_message(name):
    """One that rclpy serializes, or bytes that begin as one does."""
    messages = list(ACTS[name].messages(random.Random(1), 10**9))
    assert messages
    for topic, kind, content in messages:
        assert topic
        if not isinstance(content, bytes):
            assert isinstance(content, kind)
            content = serialize_message(content)
        assert len(content) >= 4
