"""Priority of a node's process: all of its threads, or one line."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from ev_core.methods.common_parameters import CommonParameters
from ev_nodes.stepping.stepped_node import ask_for

ASKED = CommonParameters(scheduling_priority=20)


@pytest.fixture
def thread() -> Iterator[int]:
    """The number of a thread that waits."""
    ends = threading.Event()
    waiting = threading.Thread(target=ends.wait)
    waiting.start()
    yield waiting.native_id or 0
    ends.set()
    waiting.join()


def asking(monkeypatch: pytest.MonkeyPatch, answer: Callable[[int], None]) -> list[tuple[int, int]]:
    """Threads and priorities that are asked for; `answer` may raise what the system would."""
    asked: list[tuple[int, int]] = []

    def ask(thread: int, policy: int, wanted: Any) -> None:
        assert policy == os.SCHED_FIFO
        answer(thread)
        asked.append((thread, wanted.sched_priority))

    monkeypatch.setattr(os, "sched_setscheduler", ask)
    return asked


def test_every_thread_is_asked_for(thread, monkeypatch):
    """Those of the middleware receive the messages for which a step waits."""
    asked = asking(monkeypatch, lambda _: None)
    assert [*ask_for(ASKED)] == []
    assert {(os.getpid(), 20), (thread, 20)} <= {*asked}


def test_a_thread_that_has_just_ended_is_no_refusal(thread, monkeypatch):
    """The others get their priority all the same."""

    def gone(asked: int) -> None:
        if asked != thread:
            raise ProcessLookupError

    asked = asking(monkeypatch, gone)
    assert [*ask_for(ASKED)] == []
    assert asked == [(thread, 20)]


def test_a_refusal_is_one_line_that_names_what_it_needs(monkeypatch):
    def refused(_: int) -> None:
        raise PermissionError(1, "Operation not permitted")

    asking(monkeypatch, refused)
    (line,) = ask_for(ASKED)
    assert line.startswith("SCHED_FIFO with priority 20 is not granted (Operation not permitted)")
    assert "CAP_SYS_NICE" in line
