"""Drive the cases of a study on worker processes: those of this machine, or of a dask scheduler elsewhere."""

from __future__ import annotations

import logging
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

from distributed import Client, LocalCluster, as_completed

from ev_sim.report.summary import versions
from ev_sim.run.outcome import RunFailed
from ev_sim.study.case import Case, CaseResult, Measure, drive_case

_PATIENCE = 60.0  # s for a scheduler to answer and for its first worker to join

Progress = Callable[[CaseResult], None]


def drive_cases(
    cases: Sequence[Case],
    measure: Measure | Sequence[Measure],
    progress: Progress = lambda result: None,
    scheduler: str | None = None,
    workers: int | None = None,
) -> list[CaseResult]:
    """The results of all cases, in their order, whatever the number of workers; `progress` hears of each one.

    `measure` is one function for all cases, or one for each of them.
    `scheduler` is the address of a running scheduler (tcp://HOST:PORT); without it a cluster of `workers` processes
    (as many as there are cores) lives on this machine until the end. The cases of a worker that is lost are driven
    again by others. RunFailed if there is no such scheduler, if it has no workers, or if a worker computes with other
    versions than this process.
    """
    with _client(scheduler, workers) as client:
        _refuse_other_versions(client)
        # The same case driven twice is no matter of a cache: whoever asks wants it driven.
        measures = [measure] * len(cases) if callable(measure) else measure
        futures = client.map(drive_case, cases, measures, pure=False)
        for _, result in as_completed(futures, with_results=True):
            progress(result)
        return client.gather(futures)


@contextmanager
def _client(scheduler: str | None, workers: int | None) -> Iterator[Client]:
    logging.getLogger("distributed").setLevel(logging.ERROR)
    if scheduler is None:
        with (
            LocalCluster(
                n_workers=workers or os.cpu_count(),
                threads_per_worker=1,  # one run keeps one core busy
                processes=True,
                host="127.0.0.1",
                dashboard_address="127.0.0.1:0",  # any free port, for runs side by side
                silence_logs=logging.ERROR,
            ) as cluster,
            Client(cluster) as client,
        ):
            yield client
        return
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


def _refuse_other_versions(client: Client) -> None:
    """Signals are equal to the last bit only where the same packages compute them."""
    own = versions()
    for worker, theirs in client.run(versions).items():
        for package, version in theirs.items():
            if version != own[package]:
                raise RunFailed(f"worker {worker} has {package} {version}, allowed is {own[package]} as here")
