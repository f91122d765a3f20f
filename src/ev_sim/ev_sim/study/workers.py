"""Drive the cases of a study on worker processes: those of this machine, or of a dask scheduler elsewhere."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from contextlib import suppress
from multiprocessing.connection import wait

from ev_sim.running.outcome import RunFailed
from ev_sim.study.case import Case, CaseResult, Measure, run_of
from ev_sim.study.worker import Job, Worker, WorkerLost

_LOSSES = 3  # of workers with the same case, which then is given up

Progress = Callable[[CaseResult], None]


def drive_cases(
    cases: Sequence[Case],
    measure: Measure | Sequence[Measure],
    progress: Progress = lambda result: None,
    scheduler: str | None = None,
    workers: int | None = None,
) -> list[CaseResult]:
    """The results of all cases, in their order, whatever the number of workers; `progress` hears of each one.

    `measure` is one function for all cases, or one for each of them. `scheduler` is the address of a running scheduler
    (tcp://HOST:PORT); without it `workers` processes (as many as there are cores) live on this machine until the end.
    The case of a worker that is lost is driven again by another one. RunFailed if a case loses all its workers, if
    there is no such scheduler, if it has no workers, or if one computes with other versions or sources.
    """
    jobs = [*zip(cases, [measure] * len(cases) if callable(measure) else measure, strict=True)]
    if scheduler is not None:
        from ev_sim.study.cluster import drive_on_cluster  # dask is slow to import

        return drive_on_cluster(jobs, progress, scheduler)
    return _drive_here(jobs, progress, workers or len(os.sched_getaffinity(0)))


def _drive_here(jobs: Sequence[Job], progress: Progress, count: int) -> list[CaseResult]:
    for case, _ in jobs[:1]:
        _load(case)
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
                    busy.remove(worker)
                    worker.end()
                    continue
                progress(results[number])
                if waiting:
                    worker.begin(waiting.pop())
                else:
                    busy.remove(worker)
                    worker.end()
    finally:
        for worker in busy:
            worker.end()
    return [results[number] for number in range(len(jobs))]


def _load(case: Case) -> None:
    """What driving a case needs is loaded once, for all workers that are forked then."""
    from ev_sim.running.offline import load_compiled

    with suppress(ValueError):  # a case that is refused says so when it is driven
        load_compiled(run_of(case).configurations)
