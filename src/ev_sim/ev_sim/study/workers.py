"""Drive the cases of a study on worker processes: those of this machine, or of a dask scheduler elsewhere.

Here they are forked when all that a case needs is loaded, so that they begin at once; a pool of the library ends as a
whole with one lost worker and does not name its case, and a dask cluster of this machine loads all of it anew.
"""

from __future__ import annotations

import logging
import os
import signal
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from typing import TYPE_CHECKING

from ev_sim.recording.offline import load_compiled
from ev_sim.recording.outcome import RunFailed
from ev_sim.report.summary import versions
from ev_sim.running.children import ends_with_us
from ev_sim.study.kept_rows import digest_of_sources
from ev_sim.study.study import Case, CaseResult, Measure, drive_case, run_of

if TYPE_CHECKING:
    from distributed import Client

_PATIENCE = 60.0  # s for a scheduler to answer and for its first worker to join


Job = tuple[Case, Measure]
Progress = Callable[[CaseResult], None]


def _drive_on_cluster(jobs: Sequence[Job], progress: Progress, scheduler: str) -> list[CaseResult]:
    from distributed import as_completed  # dask is slow to import

    with _client(scheduler) as client:
        refuse_others(client)
        # dask would drive the same case once only and take the rest from its cache; here each one is driven.
        futures = client.map(drive_case, *zip(*jobs, strict=True), pure=False)
        for _, result in as_completed(futures, with_results=True):
            progress(result)
        return client.gather(futures)


@contextmanager
def _client(scheduler: str) -> Iterator[Client]:
    from distributed import Client

    logging.getLogger("distributed").setLevel(logging.ERROR)
    try:
        client = Client(scheduler, timeout=_PATIENCE)
    except (OSError, ValueError) as error:
        raise RunFailed(f"scheduler {scheduler} cannot be reached: {error}") from None
    with client:
        try:
            client.wait_for_workers(1, timeout=_PATIENCE)
        except TimeoutError:
            raise RunFailed(f"scheduler {scheduler} has no workers, allowed is one or more") from None
        yield client


def refuse_others(client: Client) -> None:
    """Signals are equal to the last bit only where the same text is computed by the same packages."""
    own, sources = versions(), digest_of_sources(config=True)
    for worker, theirs in client.run(versions).items():
        for package, version in theirs.items():
            if version != own[package]:
                raise RunFailed(f"worker {worker} has {package} {version}, allowed is {own[package]} as here")
    for worker, digest in client.run(digest_of_sources, config=True).items():
        if digest != sources:
            raise RunFailed(f"worker {worker} has other sources or config files, allowed are those of here")


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
        its_end.close()  # so that the pipe ends with the process

    def fileno(self) -> int:
        """What `multiprocessing.connection.wait` waits for: the result, or the end of the process."""
        return self._connection.fileno()

    def begin(self, number: int) -> None:
        """Let it drive a case."""
        self.number = number
        with suppress(OSError):  # a process that has ended is noticed when its result is asked for
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

    Without signals of death the pipe shows its end: the own end of the parent is closed here.
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


_LOSSES = 3  # of workers with the same case, which then is given up


def drive_cases(
    cases: Sequence[Case],
    measure: Measure | Sequence[Measure],
    progress: Progress = lambda result: None,
    scheduler: str | None = None,
    workers: int | None = None,
) -> list[CaseResult]:
    """The results of all cases, in their order, whatever the number of workers; `progress` is called with each one.

    `measure` is one function for all cases, or one for each of them. `scheduler` is the address of a running scheduler
    (tcp://HOST:PORT); without it `workers` processes (as many as there are cores) live on this machine until the end.
    The case of a worker that is lost is driven again by another one. RunFailed if a case loses all its workers, if
    there is no such scheduler, if it has no workers, or if one computes with other versions or sources.
    """
    jobs = [*zip(cases, [measure] * len(cases) if callable(measure) else measure, strict=True)]
    if scheduler is not None:
        return _drive_on_cluster(jobs, progress, scheduler)
    return _drive_here(jobs, progress, workers or len(os.sched_getaffinity(0)))


def _drive_here(jobs: Sequence[Job], progress: Progress, count: int) -> list[CaseResult]:
    for case, _ in jobs[:1]:
        with suppress(ValueError):  # a case that is refused comes back as refused when it is driven
            load_compiled(run_of(case).configurations)  # once, for all workers that are forked then
    results: dict[int, CaseResult] = {}
    waiting = list(reversed(range(len(jobs))))
    losses = [0] * len(jobs)
    busy: list[Worker] = []
    try:
        while waiting or busy:
            while waiting and len(busy) < count:
                busy.append(Worker(jobs))
                busy[-1].begin(waiting.pop())
            for worker in wait(busy):
                number = worker.number
                try:
                    results[number] = worker.result()
                except WorkerLost:
                    losses[number] += 1
                    if losses[number] == _LOSSES:
                        raise RunFailed(f"{jobs[number][0].name}: {_LOSSES} workers were lost with it") from None
                    waiting.append(number)
                else:
                    progress(results[number])
                    if waiting:
                        worker.begin(waiting.pop())
                        continue
                busy.remove(worker)
                worker.end()
    finally:
        for worker in busy:
            worker.end()
    return [results[number] for number in range(len(jobs))]
