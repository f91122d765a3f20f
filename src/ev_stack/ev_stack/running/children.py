"""Processes that never outlive the one that has started them.

How it works: on Linux a child asks the system to be killed when its parent ends. What a shell
starts for a child does not inherit that, so a guard beside it waits for the end of a pipe and kills
the whole group. A forked worker also ends when its own pipe does.
"""

from __future__ import annotations

import ctypes
import os
import signal
import subprocess
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from multiprocessing import get_context
from multiprocessing.connection import Connection
from typing import Any

_SET_DEATH_SIGNAL = 1  # PR_SET_PDEATHSIG of Linux
_QUERY = 0xFFFFFFFF  # of the Linux system call `personality`: change nothing, return what is set
_ADDR_NO_RANDOMIZE = 0x0040000


def ends_with_us() -> Callable[[], None] | None:
    """Return what a child calls before it becomes the node: it is killed when we end.

    None where the system does not offer that. The signal follows the thread that starts the child:
    that must be one that lasts, such as the main thread.
    """
    prctl = getattr(ctypes.CDLL(None), "prctl", None)
    if prctl is None:
        return None
    # Taken before the fork: the child compares it with its parent by then.
    parent = os.getpid()

    def before() -> None:
        prctl(_SET_DEATH_SIGNAL, signal.SIGKILL)
        if os.getppid() != parent:  # it was too late
            os._exit(1)

    return before


def ending_with_us(group: int) -> subprocess.Popen:
    """A process that kills a process group when we end, whatever ends us.

    It is to be killed when the group has ended.

    A shell that becomes no node, but starts one, hands no death signal on.
    """
    words = ["bash", "-c", 'read -r _; kill -KILL -- "-$0"', str(group)]
    return subprocess.Popen(words, stdin=subprocess.PIPE, start_new_session=True)


@contextmanager
def same_addresses() -> Iterator[None]:
    """Processes that are started in this block have their code at the same addresses, where the system allows it.

    Nodes are one program several times, each of which runs for a moment and then waits for the
    others. A processor predicts branches by their addresses: at different ones each node finds
    predictions of another (docs/lockstep.md).
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


class WorkerLost(Exception):
    """The process has ended without an answer: killed, or out of memory."""


class Worker:
    """A process, forked off this one, that calls `perform` with one number after the other."""

    def __init__(self, perform: Callable[[int], Any]) -> None:
        self.number = -1  # that it is called with
        fork = get_context("fork")
        self._connection, its_end = fork.Pipe()
        # Both, for the child inherits our end as well, and has to close it.
        ends = (its_end, self._connection)
        self._process = fork.Process(
            target=_serve, args=(*ends, perform, ends_with_us()), daemon=True
        )
        self._process.start()
        its_end.close()  # so that the pipe ends with the process

    def fileno(self) -> int:
        """Descriptor for `multiprocessing.connection.wait`: a result, or the end of the process."""
        return self._connection.fileno()

    def begin(self, number: int) -> None:
        """Let it call `perform` with a number."""
        self.number = number
        with suppress(OSError):  # a process that has ended is noticed when its result is asked for
            self._connection.send(number)

    def result(self) -> Any:
        """Result of the work; raises WorkerLost, or the error that `perform` has raised."""
        try:
            answer = self._connection.recv()
        except (EOFError, OSError):
            raise WorkerLost from None
        if isinstance(answer, Exception):
            raise answer
        return answer

    def end(self) -> None:
        """End the process, whatever it is doing."""
        self._process.kill()
        self._process.join()
        self._connection.close()


def _serve(
    connection: Connection,
    parents: Connection,
    perform: Callable[[int], Any],
    bind: Callable[[], None] | None,
) -> None:
    """Answer until the parent ends, however it does: what it holds, the lock of its folder too, is held here as well.

    Without signals of death the pipe shows its end: the own end of the parent is closed here.
    """
    if bind is not None:
        bind()
    parents.close()
    # Ctrl-C reaches the parent as well, which ends its workers
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # Of the handlers that were inherited with the fork, none is meant for a worker.
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    with suppress(EOFError, ConnectionError):  # the parent has ended
        while True:
            number = connection.recv()
            try:
                connection.send(perform(number))
            except Exception as error:  # the parent raises it
                connection.send(error)
