"""A spoilt message is one that the wire does not repair."""

from __future__ import annotations

import random

import pytest
from campaign.spoiling import HOW, spoilt

WORD = 4  # bytes, to which DDS fills a payload up


@pytest.mark.parametrize("length", range(24, 41))
@pytest.mark.parametrize(
    "how", sorted({*HOW} - {"nan", "long", "garbage", "big endian", "far stamp"})
)
def test_a_cut_message_does_not_grow_whole_on_its_way(how, length):
    """A pose without its last byte is refused, not completed by a zero (campaign, seed 304)."""
    message = bytes(range(1, length + 1))
    for seed in range(50):
        cut = spoilt(message, how, random.Random(seed))
        assert -(-len(cut) // WORD) * WORD < length
