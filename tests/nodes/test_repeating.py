"""How often a master says its state again: soon, and where nobody answers ever more seldom."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from ev_core.nodes.master import node as node_module
from ev_core.nodes.master.node import MasterNode


def repetitions(seconds: float, now: int) -> int:
    """So many of an instant that nobody answers, looked at every millisecond of wall time."""
    said = [0.0]
    node = object.__new__(MasterNode)
    wall = SimpleNamespace(now=0.0)
    node.done = False
    node._retry_period = node_module._RETRY_PERIOD
    node._go_on = lambda: None
    node._granted = SimpleNamespace(rests=lambda: False)
    node._silence = SimpleNamespace(name_after=lambda *_: None)
    node.health, node.stepper = (
        SimpleNamespace(late_answers=0),
        SimpleNamespace(answer=None, inbox=SimpleNamespace(last=now)),
    )

    class State:
        silent_for = property(lambda _: wall.now - said[-1])
        repeat = staticmethod(lambda _: said.append(wall.now))

    node._state = State()
    node._waiting, node.wanted = SimpleNamespace(look=lambda *_: None), lambda: ()
    node.__dict__["schedule"] = SimpleNamespace(all_are_here=False, missing=(), now=now)
    node.live = SimpleNamespace(
        configuration=SimpleNamespace(
            extra=SimpleNamespace(answer_timeout=5.0), common=SimpleNamespace(mode="lockstep")
        )
    )
    for _ in range(int(seconds / 0.001)):
        wall.now += 0.001
        node.idle()
    assert node.health.late_answers == len(said) - 1
    return len(said) - 1


def test_a_recorder_that_is_held_up_for_ten_seconds_finds_all_that_was_said():
    """Publishers keep 256 messages, and the recorder may be 200 steps behind: 56 repetitions are left."""
    assert repetitions(10.0, now=10**9) < 56


def test_while_nodes_are_coming_up_they_are_called_all_the_time():
    assert repetitions(10.0, now=0) == pytest.approx(200, abs=5)
