"""Drive the cases of a study on worker processes: those of this machine, or of a dask scheduler elsewhere."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from multiprocessing.connection import wait

from ev_msgs_py.parameters.declaration import ParameterError
from ev_sim.run.outcome import RunFailed
from ev_sim.study.case import Case, CaseResult, Measure, run_of
from ev_sim.study.worker import Worker, WorkerLost

_LOSSES = 3  # of workers with the same case, which then is given up

Progress = Callable[[CaseResult], None]


def drive_cases(
    cases: Sequence[Case],
    measure: Measure,
    progress: Progress = lambda result: None,
    scheduler: str | None = None,
    workers: int | None = None,
) -> list[CaseResult]:
    """The results of all cases, in their order, whatever the number of workers; `progress` hears of each one.

    `scheduler` is the address of a running scheduler (tcp://HOST:PORT); without it `workers` processes (as many as
    there are cores) live on this machine until the end. The case of a worker that is lost is driven again by another
    one. RunFailed if a case loses all its workers, if there is no such scheduler, if it has no workers, or if one of
    them computes with other versions than this process.
    """
    if scheduler is not None:
        from ev_sim.study.cluster import drive_on_cluster  # dask is slow to import

        return drive_on_cluster(cases, measure, progress, scheduler)
    return _drive_here(cases, measure, progress, workers or len(os.sched_getaffinity(0)))


def _drive_here(cases: Sequence[Case], measure: Measure, progress: Progress, count: int) -> list[CaseResult]:
    _load(cases[:1])
    results: dict[int, CaseResult] = {}
    waiting = list(reversed(range(len(cases))))
    losses = [0] * len(cases)
    busy: list[Worker] = []
    try:
        while waiting or busy:
            while waiting and len(busy) < count:
                busy.append(Worker(cases, measure))
                busy[-1].begin(waiting.pop())
            for worker in wait(busy):
                number = worker.number
                try:
                    results[number] = worker.result()
                except WorkerLost:
                    losses[number] += 1
                    if losses[number] == _LOSSES:
                        raise RunFailed(f"{cases[number].name}: {_LOSSES} workers were lost with it") from None
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
    return [results[number] for number in range(len(cases))]


def _load(cases: Sequence[Case]) -> None:
    """What driving these cases needs is loaded once, for all workers that are forked then."""
    from ev_msgs_py.lockstep.run import GraphRun

    for case in cases:
        try:
            GraphRun(run_of(case).configurations, 1)
        except (ParameterError, ValueError):
            continue  # it says so when it is driven
