"""Jobs on worker processes: those of this machine, or those of a dask scheduler elsewhere.

How it works: a job is a function and what it is called with. `perform_jobs` gives each free worker
the next job, and calls `done` with every result as it comes, in any order; it keeps none of them.

Two pools do this. The one of this machine forks its workers when all that a job needs is compiled
and loaded. A dask cluster on this machine would load it again in each worker: measured with two
workers, the first row comes after 8 s instead of 0.3 s, and takes twice the memory; dask is also
optional. The pools of Python's library end as a whole with one lost worker and do not name its job.
The other pool is for other machines, which have to compute with the same packages, sources and
files.
"""

from __future__ import annotations

import logging
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.connection import wait
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ev_core.parameters.data_file import config_folders, files_read
from ev_stack.recording.outcome import RunFailed, bar_of_runs
from ev_stack.report.summary import versions
from ev_stack.running.children import Worker, WorkerLost
from ev_study.studies.digests import digest_of, digest_of_sources

if TYPE_CHECKING:
    from distributed import Client

_PATIENCE = 60.0  # s for a scheduler to answer and for its first worker to join
_LOSSES = 3  # of workers with the same job, which then is given up


@dataclass(frozen=True, slots=True)
class Job:
    """A function that a worker calls, and with what; `name` is for messages, `runs` for the bar."""

    name: str
    perform: Callable[..., Any]
    given: tuple[Any, ...]
    runs: int = 1

    def __call__(self) -> Any:
        """Perform it."""
        return self.perform(*self.given)


@dataclass(frozen=True, slots=True)
class Workers:
    """Processes for jobs: `count` of them here, or the workers of a dask scheduler.

    As many processes as there are cores without a count. The address is tcp://HOST:PORT.
    """

    count: int | None = None
    scheduler: str | None = None

    @property
    def here(self) -> int:
        """Number of processes of this machine."""
        return self.count or len(os.sched_getaffinity(0))


HERE = Workers()
Done = Callable[[int, Any], None]  # is called with number and result of a job


def perform_jobs(
    name: str, jobs: Sequence[Job], done: Done, workers: Workers, before: int = 0
) -> None:
    """Perform jobs behind a bar called `name`, which counts their runs on from those `before`.

    The job of a worker that is lost is performed again by another one. RunFailed if a job loses
    all its workers, if the scheduler or its workers are missing, or if a worker of it computes with
    other versions, sources or files.
    """
    perform = _perform_here if workers.scheduler is None else _perform_on_cluster
    with bar_of_runs(name, before + sum(job.runs for job in jobs), before) as bar:

        def done_and_counted(number: int, result: Any) -> None:
            done(number, result)
            bar.update(jobs[number].runs)

        if jobs:  # else there is no reason to ask a scheduler
            perform(jobs, done_and_counted, workers)


def _perform_here(jobs: Sequence[Job], done: Done, workers: Workers) -> None:
    # Reversed, so that pop gives the first job first.
    waiting = list(reversed(range(len(jobs))))
    losses = [0] * len(jobs)
    busy: list[Worker] = []
    try:
        while waiting or busy:
            while waiting and len(busy) < workers.here:
                # A fork: the worker has the jobs already, and gets only their numbers.
                busy.append(Worker(lambda number: jobs[number]()))
                busy[-1].begin(waiting.pop())
            for worker in wait(busy):
                number = worker.number
                try:
                    result = worker.result()
                except WorkerLost:
                    losses[number] += 1
                    if losses[number] == _LOSSES:
                        lost = f"{_LOSSES} workers were lost with it"
                        raise RunFailed(f"{jobs[number].name}: {lost}") from None
                    # At the end, so it is the next one that is begun.
                    waiting.append(number)
                else:
                    done(number, result)
                    if waiting:
                        worker.begin(waiting.pop())
                        continue
                # The process is lost, or there is no more work for it.
                busy.remove(worker)
                worker.end()
    finally:
        # After an error or Ctrl-C they still have jobs with results that are not waited for.
        for worker in busy:
            worker.end()


def _perform_on_cluster(jobs: Sequence[Job], done: Done, workers: Workers) -> None:
    from distributed import as_completed  # dask is slow to import

    with _client(workers.scheduler or "") as client:
        refuse_others(client)
        # dask would perform the same job once only and take the rest from its cache.
        futures = client.map(_performed, jobs, pure=False)
        numbers = {future.key: number for number, future in enumerate(futures)}
        for future, (result, *read) in as_completed(futures, with_results=True):
            refuse_other_files(*read)
            done(numbers[future.key], result)
            future.release()  # its worker need not keep the result any more


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
            raise RunFailed(f"scheduler {scheduler} has no workers, expected one or more") from None
        yield client


def refuse_others(client: Client) -> None:
    """RunFailed for a worker with other packages or sources: its signals may differ in a bit."""
    own = versions()
    for worker, theirs in client.run(versions).items():
        for package, version in theirs.items():
            # Another version of numpy or of a compiler may round otherwise.
            if version != own[package]:
                expected = f"expected {own[package]} as here"
                raise RunFailed(f"worker {worker} has {package} {version}, {expected}")
    sources = digest_of_sources(config=True, others=True)
    for worker, digest in client.run(digest_of_sources, config=True, others=True).items():
        if digest != sources:
            expected = "expected those of here"
            raise RunFailed(f"worker {worker} has other sources or config files, {expected}")


def _performed(job: Job) -> tuple[Any, str, Path, dict[str, str]]:
    """A result, its worker and that one's folder, and by path the SHA-256 of the files it has read.

    Those below config folders are left out: all of them are compared before.
    """
    from distributed import get_worker

    with files_read() as read:
        result = job()
    config = config_folders()
    own = {
        path: digest
        for path, digest in read.items()
        if not any(map(Path(path).is_relative_to, config))
    }
    return result, get_worker().address, Path.cwd(), own


def refuse_other_files(worker: str, folder: Path, files: Mapping[str, str]) -> None:
    """RunFailed if a file that a worker has read is another one here, by SHA-256, or is not here.

    A file below the working folder of the worker is looked for below the one here.
    """
    for path, digest in files.items():
        here = Path(path)
        # A dask worker may run in another folder with a copy of the user's files.
        if here.is_relative_to(folder) and here.relative_to(folder).is_file():
            here = here.relative_to(folder)
        if not (here.is_file() and digest_of(here) == digest):
            expected = "expected the same file"
            raise RunFailed(f"worker {worker} has read another {path} than {here} here, {expected}")
