"""Processes that never outlive the one that has started them."""

from __future__ import annotations

import ctypes
import os
import signal
import subprocess
from collections.abc import Callable, Iterator
from contextlib import contextmanager

_SET_DEATH_SIGNAL = 1  # PR_SET_PDEATHSIG of Linux


def ends_with_us() -> Callable[[], None] | None:
    """What a child calls before it becomes the node: it is killed when we end, whatever ends us.

    None where the system does not offer that. The signal follows the thread that starts the child: that must be one
    that lasts, such as the main thread.
    """
    prctl = getattr(ctypes.CDLL(None), "prctl", None)
    if prctl is None:
        return None
    parent = os.getpid()

    def before() -> None:
        prctl(_SET_DEATH_SIGNAL, signal.SIGKILL)
        if os.getppid() != parent:  # it was too late
            os._exit(1)

    return before


def ending_with_us(group: int) -> subprocess.Popen:
    """A process that kills a process group when we end, whatever ends us; to be killed when the group has ended.

    A shell that becomes no node, but starts one, hands no death signal on.
    """
    words = ["bash", "-c", 'read -r _; kill -KILL -- "-$0"', str(group)]
    return subprocess.Popen(words, stdin=subprocess.PIPE, start_new_session=True)


_QUERY = 0xFFFFFFFF  # of the Linux system call `personality`: change nothing, return what is set
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
