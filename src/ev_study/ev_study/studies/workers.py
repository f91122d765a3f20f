"""Cases of a study, and other jobs, on worker processes: those of this machine, or of a dask scheduler elsewhere.

Here they are forked when all that a job needs is loaded, so that they begin at once; a pool of the
library ends as a whole with one lost worker and does not name its job, and a dask cluster of this
machine loads all of it anew.
"""

from __future__ import annotations

import logging
import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from multiprocessing.connection import wait
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ev_core.parameters.data_file import config_folders, files_read
from ev_stack.recording.offline import graph_run, run_offline
from ev_stack.recording.outcome import RunFailed
from ev_stack.report.summary import versions
from ev_stack.running.beforehand import compile_for
from ev_stack.running.children import Worker, WorkerLost
from ev_stack.running.folder_content import digest_of
from ev_stack.scenarios.scenario import Run
from ev_study.studies.digests import digest_of_sources
from ev_study.studies.study import Case, CaseResult, Measure, drive_case, run_of

if TYPE_CHECKING:
    from distributed import Client

_PATIENCE = 60.0  # s for a scheduler to answer and for its first worker to join
_LOSSES = 3  # of workers with the same job, which then is given up

Perform = Callable[..., Any]
Job = tuple[Any, ...]  # what it is performed with
Done = Callable[[int, Any], None]


def perform_jobs(
    perform: Perform,
    jobs: Sequence[Job],
    done: Done,
    scheduler: str | None = None,
    workers: int | None = None,
    name: Callable[..., str] = str,
) -> None:
    """Perform jobs; `done` is called with number and result of each as it comes, and nothing else is kept of it.

    `scheduler` is the address of a running scheduler (tcp://HOST:PORT); without it `workers`
    processes (as many as there are cores) live on this machine until the end. The job of a worker
    that is lost is performed again by another one. RunFailed if a job, by its `name`, loses all its
    workers, if there is no such scheduler, if it has no workers, or if one computes with other
    versions, sources or files.
    """
    if scheduler is not None:
        _perform_on_cluster(perform, jobs, done, scheduler)
    else:
        _perform_here(perform, jobs, done, workers or len(os.sched_getaffinity(0)), name)


def _perform_on_cluster(perform: Perform, jobs: Sequence[Job], done: Done, scheduler: str) -> None:
    from distributed import as_completed  # dask is slow to import

    with _client(scheduler) as client:
        refuse_others(client)
        # dask would perform the same job once only and take the rest from its cache; here each one
        # is performed.
        futures = client.map(partial(_performed, perform), *zip(*jobs, strict=True), pure=False)
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
    """Signals are equal to the last bit only where the same text is computed by the same packages."""
    own, sources = versions(), digest_of_sources(config=True, others=True)
    for worker, theirs in client.run(versions).items():
        for package, version in theirs.items():
            if version != own[package]:
                raise RunFailed(
                    f"worker {worker} has {package} {version}, expected {own[package]} as here"
                )
    for worker, digest in client.run(digest_of_sources, config=True, others=True).items():
        if digest != sources:
            raise RunFailed(
                f"worker {worker} has other sources or config files, expected those of here"
            )


def _performed(perform: Perform, *job: Any) -> tuple[Any, str, Path, dict[str, str]]:
    """A result, the worker that it is of and its folder, and by path the SHA-256 of the files that were read for it.

    Those below config folders are left out: all of them are compared before.
    """
    from distributed import get_worker

    with files_read() as read:
        result = perform(*job)
    config = config_folders()
    own = {
        path: digest
        for path, digest in read.items()
        if not any(map(Path(path).is_relative_to, config))
    }
    return result, get_worker().address, Path.cwd(), own


def refuse_other_files(worker: str, folder: Path, files: Mapping[str, str]) -> None:
    """RunFailed if a file that a worker has read is another one here, by SHA-256, or is not here.

    What lies below the working folder of the worker is looked for below the one here.
    """
    for path, digest in files.items():
        here = Path(path)
        if here.is_relative_to(folder) and here.relative_to(folder).is_file():
            here = here.relative_to(folder)
        if not (here.is_file() and digest_of(here) == digest):
            raise RunFailed(
                f"worker {worker} has read another {path} than {here} here, expected the same file"
            )


def drive_cases(
    cases: Sequence[Case],
    measure: Measure | Sequence[Measure],
    progress: Callable[[CaseResult], None] = lambda result: None,
    scheduler: str | None = None,
    workers: int | None = None,
) -> list[CaseResult]:
    """The results of all cases, in their order, whatever the number of workers; `progress` is called with each one.

    `measure` is one function for all cases, or one for each of them. `scheduler` and `workers`, and
    what is raised, are those of `perform_jobs`.
    """
    jobs = [*zip(cases, [measure] * len(cases) if callable(measure) else measure, strict=True)]
    results: dict[int, CaseResult] = {}

    def done(number: int, result: CaseResult) -> None:
        results[number] = result
        progress(result)

    if scheduler is None:
        _load(cases)
    perform_jobs(drive_case, jobs, done, scheduler, workers, lambda case, _: case.name)
    return [results[number] for number in range(len(jobs))]


_SAMPLE = 1.0  # s of simulated time that tell how fast a case is


def estimated_time(cases: Sequence[Case], workers: int | None = None) -> float:
    """About how long some cases take here [s], from the first of them that is not refused; 0 if all are.

    What it needs is compiled before; others may need more.
    """
    for case in cases:
        with suppress(ValueError):
            start = time.monotonic()
            run = run_of(case)
            resolving = time.monotonic() - start
            compile_for([run], in_nodes=False)
            sample = min(_SAMPLE, run.duration)
            times = []
            for duration in (0.0, 0.0, sample):  # the first one loads what all need
                start = time.monotonic()
                run_offline(run.configurations, duration)
                times.append(time.monotonic() - start)
            rate = max(times[2] - times[1], 0.0) / sample
            each = resolving + times[1] + rate * run.duration
            return each * len(cases) / min(workers or len(os.sched_getaffinity(0)), len(cases))
    return 0.0


def _perform_here(
    perform: Perform, jobs: Sequence[Job], done: Done, count: int, name: Callable[..., str]
) -> None:
    waiting = list(reversed(range(len(jobs))))
    losses = [0] * len(jobs)
    busy: list[Worker] = []
    try:
        while waiting or busy:
            while waiting and len(busy) < count:
                busy.append(Worker(lambda number: perform(*jobs[number])))
                busy[-1].begin(waiting.pop())
            for worker in wait(busy):
                number = worker.number
                try:
                    result = worker.result()
                except WorkerLost:
                    losses[number] += 1
                    if losses[number] == _LOSSES:
                        raise RunFailed(
                            f"{name(*jobs[number])}: {_LOSSES} workers were lost with it"
                        ) from None
                    waiting.append(number)
                else:
                    done(number, result)
                    if waiting:
                        worker.begin(waiting.pop())
                        continue
                busy.remove(worker)
                worker.end()
    finally:
        for worker in busy:
            worker.end()


def _load(cases: Sequence[Case]) -> None:
    """Compile what the cases need, and load what driving them needs once, for all workers that are forked then."""
    alike = {
        (case.scenario, case.run, case.vehicle, case.files, _methods(case)): case for case in cases
    }
    runs = []
    for case in alike.values():
        with suppress(ValueError):  # a case that is refused comes back as refused when it is driven
            runs.append(run_of(case))
    load_for(runs)


def load_for(runs: Sequence[Run]) -> None:
    """Compile what runs need, and load the code of the first one, for all workers that are forked then."""
    compile_for(runs, in_nodes=False)
    for run in runs[:1]:
        with suppress(ValueError):
            graph_run(run.configurations, 0.0)


def _methods(case: Case) -> tuple[str, ...]:
    return tuple(f"{node} {value}" for node, name, value in case.values if name == "method")
