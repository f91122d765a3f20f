"""Ctrl-C and SIGTERM end every run, also where a compiled law never returns.

It costs nothing but the law's process.
"""

from __future__ import annotations

import gc
import os
import signal
import subprocess
import sys
import threading
import weakref
from contextlib import suppress
from itertools import product
from pathlib import Path

import pytest
from helpers.patience import wait_until
from running import endless_law

from ev_core.compiled.interruptible import REQUESTS, interruptible
from ev_core.lockstep.run import guarded

COMMANDS = ("offline", "in one process", "as processes")
BY_WORKERS = ("sweep, its workers", "benchmark, its workers", "tune, its batches")
BEFORE_THEM = ("sweep, its estimate", "compare", "benchmark, the contract", "tune, the contract")
KINDS = (signal.SIGINT, signal.SIGTERM)


def ended(way: str, folder: Path, kind: signal.Signals) -> subprocess.CompletedProcess[str]:
    """Run a command that is asked to stop once its law is in its loop.

    The law has no end, so nothing but the signal can end the run: how long that takes is no part of
    the test.
    """
    words = [sys.executable, endless_law.__file__, way, str(folder)]
    environment = {**os.environ, "TEST_SIGNAL": str(int(kind))}
    return subprocess.run(words, capture_output=True, text=True, env=environment, timeout=900)


@pytest.mark.slow
@pytest.mark.sampled
@pytest.mark.parametrize(("way", "kind"), [*product(COMMANDS, KINDS)])
def test_a_command_ends_with_one_line(way: str, kind: signal.Signals, tmp_path: Path):
    """It does not hang, which the limit of the process shows."""
    assert_stopped(ended(way, tmp_path, kind))


@pytest.mark.slow
@pytest.mark.sampled
@pytest.mark.parametrize(("way", "kind"), [*product(BY_WORKERS, KINDS)])
def test_many_runs_end_with_one_line(way: str, kind: signal.Signals, tmp_path: Path):
    """The workers stand in the law, and end with the command: else its output would not end."""
    assert_stopped(ended(way, tmp_path, kind))


@pytest.mark.weekly
@pytest.mark.parametrize("way", BEFORE_THEM)
def test_what_comes_before_many_runs_ends_with_one_line(way: str, tmp_path: Path):
    """A study times its first run, and an added law is held against the contract."""
    assert_stopped(ended(way, tmp_path, signal.SIGINT))


def assert_stopped(done: subprocess.CompletedProcess[str]) -> None:
    """It has ended as shells expect it of a command that was stopped."""
    assert (done.returncode, done.stderr.splitlines()[-1]) == (130, "stopped"), done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.slow
@pytest.mark.parametrize(
    "way", ["run", "batch", pytest.param("simulation", marks=pytest.mark.weekly)]
)
def test_a_call_from_python_raises_keyboard_interrupt(way: str, tmp_path: Path):
    """A notebook goes on, with its variables."""
    done = ended(way, tmp_path, signal.SIGINT)
    assert done.stderr.splitlines()[-1] == "KeyboardInterrupt", done.stderr


def test_what_a_call_gives_and_raises_comes_through():
    """One after the other, by the same thread, and after an error."""
    assert [interruptible(lambda n=n: n * n) for n in range(3)] == [0, 1, 4]
    with pytest.raises(ZeroDivisionError):
        interruptible(lambda: 1 // 0)
    assert interruptible(lambda: "again") == "again"


def test_a_request_to_stop_does_not_end_a_call_that_returns():
    """Only one that goes on for longer than the request can wait."""
    REQUESTS.append(lambda: True)
    try:
        assert interruptible(lambda: 1) == 1
    finally:
        REQUESTS.pop()


class Memory:
    """Memory of a part with a law that may never end."""

    is_checked = True


def test_the_memory_of_a_call_that_is_given_up_lasts_as_long_as_the_call():
    """It goes on in its thread, and works on that memory."""
    memory, ends = Memory(), threading.Event()
    kept = weakref.ref(memory)
    REQUESTS.append(lambda: True)
    try:
        # which pytest would keep, with all that stands in its frames
        with suppress(KeyboardInterrupt):
            guarded([memory], ends.wait)
        del memory
        gc.collect()
        assert kept() is not None
    finally:
        REQUESTS.pop()
        ends.set()
    wait_until(lambda: kept() is None)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
def test_a_forked_process_has_threads_of_its_own():
    """Those of the parent are not there: to wait for one of them would last for ever."""
    interruptible(lambda: None)
    child = os.fork()
    if child == 0:
        os._exit(interruptible(lambda: 7))
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7
