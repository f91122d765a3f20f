"""Drive the cases of a study on the workers of a dask scheduler."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

from ev_sim.recording.outcome import RunFailed
from ev_sim.report.summary import versions
from ev_sim.study.case import Case, CaseResult, Measure, drive_case
from ev_sim.study.depends import digest_of_sources

if TYPE_CHECKING:
    from distributed import Client

_PATIENCE = 60.0  # s for a scheduler to answer and for its first worker to join


def drive_on_cluster(
    jobs: Sequence[tuple[Case, Measure]], progress: Callable[[CaseResult], None], scheduler: str
) -> list[CaseResult]:
    """The results of all cases, each with what measures it, in their order; `scheduler` is an address, tcp://HOST:PORT.

    The cases of a worker that is lost are driven again by others. RunFailed if there is no such scheduler, if it has no
    workers, or if a worker computes with other versions, sources or config files than this process.
    """
    from distributed import as_completed  # dask is slow to import

    with _client(scheduler) as client:
        refuse_others(client)
        # The same case driven twice is no matter of a cache: whoever asks wants it driven.
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
