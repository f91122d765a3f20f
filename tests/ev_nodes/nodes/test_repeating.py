"""A master repeats its state soon, and without an answer ever more seldom."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from ev_nodes.master import node as node_module
from ev_nodes.master.node import MasterNode


def repetitions(monkeypatch, seconds: float, now: int) -> int:
    """Times of the first repetitions of an unanswered instant, looked at every millisecond."""
    times = [0.0]
    node = object.__new__(MasterNode)
    wall = SimpleNamespace(now=0.0)
    node.done = False
    node._retry_period = node_module._RETRY_PERIOD
    node._go_on = lambda: None
    node._silence = SimpleNamespace(name_after=lambda *_: None)
    node.health, node.stepper = (
        SimpleNamespace(late_answers=0),
        SimpleNamespace(answer=None, inbox=SimpleNamespace(last=now)),
    )

    monkeypatch.setattr(node_module.time, "monotonic", lambda: wall.now)
    node._spoke = 0.0

    def repeat() -> None:
        times.append(wall.now)
        node._spoke = wall.now

    node._repeat = repeat
    node._waiting, node.wanted = SimpleNamespace(look=lambda *_: None), lambda: ()
    node.__dict__["schedule"] = SimpleNamespace(
        all_are_here=False, missing=(), now=now, rests=False
    )
    node.configuration = SimpleNamespace(
        extra=SimpleNamespace(answer_timeout=5.0), common=SimpleNamespace(mode="lockstep")
    )
    for _ in range(int(seconds / 0.001)):
        wall.now += 0.001
        node.idle()
    assert node.health.late_answers == len(times) - 1
    return len(times) - 1


def test_a_recorder_that_is_held_up_for_ten_seconds_finds_all_messages(monkeypatch):
    """Publishers keep 256 messages, and the recorder may be 200 steps behind.

    56 repetitions are left.
    """
    assert repetitions(monkeypatch, 10.0, now=10**9) < 56


def test_while_nodes_are_coming_up_they_are_called_all_the_time(monkeypatch):
    assert repetitions(monkeypatch, 10.0, now=0) == pytest.approx(200, abs=5)
