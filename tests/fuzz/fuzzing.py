"""Number of cases of each test: few and always the same, or as scripts/fuzz.sh is given."""

from __future__ import annotations

import os
import random
from collections.abc import Callable
from typing import Any

from campaign.damage import DAMAGES
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st

_WEIGHTS = 21.4  # of all tests, by which they share the cases of the long form
_ASKED = int(os.environ.get("EV_FUZZ_CASES", "0"))
LONGEST_LINE = 4000  # characters: a refusal has to be readable

seeds = st.integers(0, 2**32 - 1)
# of the content of a file, see `spoil`
damaged = st.tuples(st.sampled_from(sorted(DAMAGES)), seeds)


def fuzzed(few: int, weight: float = 1.0) -> Callable[[Any], Any]:
    """Set the number of cases: so many in the suite, their share in the long form.

    A slow test has a small weight.
    """
    return settings(
        max_examples=max(round(_ASKED * weight / _WEIGHTS), 1) if _ASKED else few,
        derandomize=not _ASKED,
        database=None,
        deadline=None,
        suppress_health_check=list(HealthCheck),
    )


def spoil(content: bytes, damage: tuple[str, int]) -> bytes:
    """A file's content with a damage drawn from `damaged`."""
    how, seed = damage
    return DAMAGES[how](content, random.Random(seed))


def assert_one_line(error: BaseException | str) -> None:
    """A refusal that fits on a line of a terminal, more or less."""
    text = str(error)
    assert text and "\n" not in text and "\r" not in text, repr(text)
    assert len(text) <= LONGEST_LINE, f"{len(text)} characters: {text[:200]}"
