"""A run restarts its nodes if they have lost each other because the time of day was set back."""

from __future__ import annotations

import math
from types import SimpleNamespace

import pytest
from helpers.ros_graph import offline_hash, recorded_hash, shchur

from ev_nodes.stepping import time_of_day
from ev_stack.recording.outcome import RunFailed
from ev_stack.running import processes
from ev_stack.running.processes import Beginning

HOUR = 3600 * 10**9  # ns
PATIENCE = 3.0  # s


@pytest.fixture
def clocks(monkeypatch):
    """Seconds of the monotonic clock, and nanoseconds by which the time of day is ahead of it."""
    now = SimpleNamespace(seconds=100.0, ahead=HOUR)
    monkeypatch.setattr(processes.time, "monotonic", lambda: now.seconds)
    monkeypatch.setattr(time_of_day, "ahead", lambda: now.ahead)
    monkeypatch.setattr(processes, "ahead", lambda: now.ahead)
    monkeypatch.setattr(processes, "_TO_BEGIN", PATIENCE)
    return now


def waited(
    begins: Beginning, run: SimpleNamespace, clocks: SimpleNamespace, most: float = 60.0
) -> float:
    """Seconds until the run counts as not begun, infinite if it does not within `most`."""
    start = clocks.seconds
    while clocks.seconds < start + most:
        if begins.is_missed(run):
            return clocks.seconds - start
        clocks.seconds += 0.05
    return math.inf


def standing() -> SimpleNamespace:
    """A run without a step, as its runner sees it."""
    return SimpleNamespace(time=0.0, rests=False)


def test_a_run_that_takes_no_step_behind_a_set_back_has_not_begun(clocks):
    begins = Beginning()
    clocks.ahead = 0
    assert waited(begins, standing(), clocks) == pytest.approx(PATIENCE, abs=0.1)


@pytest.mark.parametrize(
    "jump", [0, HOUR, -500_000], ids=["none", "ahead", "by half a millisecond"]
)
def test_without_a_set_back_a_run_may_take_its_time(jump, clocks):
    """A node of a user's own may load for a minute, or stand at a breakpoint.

    Clocks are slewed all the time.
    """
    begins = Beginning(patient=True)
    clocks.ahead += jump
    assert waited(begins, standing(), clocks) == math.inf


def test_a_run_of_our_own_nodes_that_takes_no_step_at_all_ends_in_one_line(clocks):
    """The middleware may let no node find another one.

    A run that a service has stopped may rest.
    """
    begins, run = Beginning(), standing()
    with pytest.raises(
        RunFailed, match=r"^no step was taken within 300 s: the nodes do not find or answer each"
    ):
        waited(begins, run, clocks, 301.0)
    begins, run.rests = Beginning(), True
    assert waited(begins, run, clocks, 301.0) == math.inf


def test_a_run_that_goes_on_has_begun(clocks):
    """Nodes that know each other do not find each other again."""
    begins, run = Beginning(), standing()
    run.time = 0.01
    clocks.ahead = 0
    assert waited(begins, run, clocks) == math.inf


def test_a_run_that_makes_its_first_step_behind_the_set_back_has_begun(clocks):
    begins, run = Beginning(), standing()
    clocks.ahead = 0
    assert waited(begins, run, clocks, 0.9 * PATIENCE) == math.inf
    run.time = 0.01
    assert waited(begins, run, clocks) == math.inf


def test_while_time_is_stopped_no_run_can_begin(clocks):
    """A service can stop time before the first step."""
    begins, run = Beginning(), standing()
    run.rests = True
    clocks.ahead = 0
    assert waited(begins, run, clocks) == math.inf
    run.rests = False
    assert waited(begins, run, clocks) == pytest.approx(PATIENCE, abs=0.1)


@pytest.mark.weekly
def test_the_nodes_of_a_run_that_has_not_begun_are_restarted(tmp_path, monkeypatch, capsys):
    """They write into the same folder, where the first recorder has begun a bag.

    The result is right and a line reports the restart.
    """
    begun = []

    class OnceNotBegun(Beginning):
        def __init__(self, patient: bool) -> None:
            begun.append(self)

        def is_missed(self, observer) -> bool:
            return self is begun[0] and (tmp_path / "bag").exists()

    monkeypatch.setattr(processes, "Beginning", OnceNotBegun)
    run = shchur(0.1)
    outcome = processes.run_in_processes(run, tmp_path, True, lambda _: None)
    assert len(begun) == 2
    assert recorded_hash(tmp_path) == offline_hash(run)
    assert outcome.recording.time[-1] == pytest.approx(0.1)
    assert [*(tmp_path / "bag").glob("*.mcap")]
    assert (
        capsys.readouterr().err.count("the run has not begun since: its nodes are restarted") == 1
    )
