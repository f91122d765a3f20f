"""Processes at the same addresses: what the processor learns about one node's branches serves the others as well."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager

_QUERY = 0xFFFFFFFF  # of the Linux system call `personality`: change nothing, tell what is set
_ADDR_NO_RANDOMIZE = 0x0040000


@contextmanager
def same_addresses() -> Iterator[None]:
    """Processes that are started in this block have their code at the same addresses, where the system allows it.

    Nodes are one program several times, each of which runs for a moment and then waits for the others. A processor
    predicts branches by their addresses: at different ones each node finds predictions of another (docs/lockstep.md).
    """
    personality = getattr(ctypes.CDLL(None), "personality", None)
    before = -1 if personality is None else personality(ctypes.c_ulong(_QUERY))
    if before < 0 or personality(ctypes.c_ulong(before | _ADDR_NO_RANDOMIZE)) < 0:
        yield  # another system, or a container that forbids it: slower, and nothing else
        return
    try:
        yield
    finally:
        personality(ctypes.c_ulong(before))
