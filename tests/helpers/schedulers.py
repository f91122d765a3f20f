"""Dask schedulers and workers, all processes of their own."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def process(*words: str, folder: Path | None = None) -> Iterator[subprocess.Popen]:
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join([str(Path(__file__).parents[1]), *sys.path[1:]]),
    }
    started = subprocess.Popen(
        [sys.executable, "-m", *words],
        env=environment,
        cwd=folder,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        yield started
    finally:
        started.kill()
        started.wait()


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def wait_for_listener(port: int) -> None:
    """A scheduler takes longer to start than what is waited for its workers here.

    The time limit of a test ends it.
    """
    while True:
        with socket.socket() as probe:
            if probe.connect_ex(("127.0.0.1", port)) == 0:
                return
        time.sleep(0.05)


@contextmanager
def scheduler_with_two_workers(
    folder: Path | None = None,
) -> Iterator[tuple[str, subprocess.Popen]]:
    """The address of a scheduler, and one of its workers, which may be killed.

    They work in a folder.
    """
    address = f"tcp://127.0.0.1:{free_port()}"
    host, port = address.removeprefix("tcp://").split(":")
    worker = (
        "distributed.cli.dask_worker",
        address,
        "--nthreads",
        "1",
        "--no-nanny",
        "--no-dashboard",
    )
    with (
        process("distributed.cli.dask_scheduler", "--host", host, "--port", port, "--no-dashboard"),
        process(*worker, folder=folder),
        process(*worker, folder=folder) as victim,
    ):
        yield address, victim
