"""Nodes of a run are started at the same addresses, and nothing else is."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from ev_stack.running.children import same_addresses

SHOW = [sys.executable, "-c", "print(open('/proc/self/personality').read())"]
NO_RANDOMIZE = 0x0040000


def started() -> int:
    """Start a process and return the number that it prints."""
    return int(subprocess.run(SHOW, capture_output=True, check=True, text=True).stdout, 16)


@pytest.mark.skipif(
    not Path("/proc/self/personality").exists(), reason="Linux tells the personality of a process"
)
def test_only_what_is_started_in_the_block_is_at_fixed_addresses():
    before = started()
    with same_addresses():
        inside = started()
    assert inside in (before | NO_RANDOMIZE, before)  # as it was where a container forbids it
    assert started() == before
