"""One worker process of this machine: forked off, it has all cases already and is told their numbers."""

from __future__ import annotations

import signal
from collections.abc import Callable, Sequence
from contextlib import suppress
from multiprocessing import get_context
from multiprocessing.connection import Connection

from ev_sim.running.children import ends_with_us
from ev_sim.study.case import Case, CaseResult, Measure, drive_case

Job = tuple[Case, Measure]

_FORK = get_context("fork")


class WorkerLost(Exception):
    """The process has ended without an answer: killed, or out of memory."""


class Worker:
    """A process that drives one case after the other."""

    def __init__(self, jobs: Sequence[Job]) -> None:
        self.number = -1  # of the case that it drives
        self._connection, its_end = _FORK.Pipe()
        ends = (its_end, self._connection)
        self._process = _FORK.Process(target=_serve, args=(*ends, jobs, ends_with_us()), daemon=True)
        self._process.start()
        its_end.close()  # so that the end of the process is heard

    def fileno(self) -> int:
        """What `multiprocessing.connection.wait` waits for: the result, or the end of the process."""
        return self._connection.fileno()

    def begin(self, number: int) -> None:
        """Let it drive a case."""
        self.number = number
        with suppress(OSError):  # a process that has ended is noticed by who waits for its result
            self._connection.send(number)

    def result(self) -> CaseResult:
        """That of its case; raises WorkerLost, and what `measure` has raised."""
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


def _serve(connection: Connection, parents: Connection, jobs: Sequence[Job], bind: Callable[[], None] | None) -> None:
    """Answer until the parent ends, however it does: what it holds, the lock of its folder too, is held here as well.

    Without signals of death its end is heard by the pipe, of which its own end is closed here.
    """
    if bind is not None:
        bind()
    parents.close()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the parent as well, which ends its workers
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    with suppress(EOFError, ConnectionError):  # the parent has ended
        while True:
            number = connection.recv()
            try:
                connection.send(drive_case(*jobs[number]))
            except Exception as error:  # the parent raises it
                connection.send(error)
