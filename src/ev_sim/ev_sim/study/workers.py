"""Drive the cases of a study on worker processes: those of this machine, or of a dask scheduler elsewhere.

Here they are forked when all that a case needs is loaded, so that they begin at once; a pool of the library ends as a
whole with one lost worker and does not name its case, and a dask cluster of this machine loads all of it anew.
"""

from __future__ import annotations

import logging
import os
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from multiprocessing.connection import wait
from typing import TYPE_CHECKING

from ev_sim.recording.offline import load_compiled, run_offline
from ev_sim.recording.outcome import RunFailed
from ev_sim.report.summary import versions
from ev_sim.running.beforehand import compile_for
from ev_sim.running.children import Worker, WorkerLost
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


def _drive_here(jobs: Sequence[Job], progress: Progress, count: int) -> list[CaseResult]:
    _load([case for case, _ in jobs])
    results: dict[int, CaseResult] = {}
    waiting = list(reversed(range(len(jobs))))
    losses = [0] * len(jobs)
    busy: list[Worker] = []
    try:
        while waiting or busy:
            while waiting and len(busy) < count:
                busy.append(Worker(lambda number: drive_case(*jobs[number])))
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


def _load(cases: Sequence[Case]) -> None:
    """Compile what the cases need, and load what driving them needs once, for all workers that are forked then."""
    alike = {(case.scenario, case.run, case.vehicle, case.files, _methods(case)): case for case in cases}
    runs = []
    for case in alike.values():
        with suppress(ValueError):  # a case that is refused comes back as refused when it is driven
            runs.append(run_of(case))
    compile_for(runs, in_nodes=False)
    for run in runs[:1]:
        with suppress(ValueError):
            load_compiled(run.configurations)


def _methods(case: Case) -> tuple[str, ...]:
    return tuple(f"{node} {value}" for node, name, value in case.values if name == "method")
