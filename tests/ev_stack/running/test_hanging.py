"""Node that is named when a run stands still."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from types import MappingProxyType, SimpleNamespace

import pytest

from ev_nodes.master.node import MasterNode
from ev_nodes.stepping.runner_line import WAITS, RunnerLine, Waiting, Word
from ev_stack.running import processes
from ev_stack.running.node_reports import NodeReports
from ev_stack.running.processes import Hanging

PIDS = dict.fromkeys(("plant", "driver", "electronic_differential", "asr", "recorder"), 1)


def named(
    waits: dict[str, tuple[str, ...]],
    realtime: bool = False,
    pids: dict[str, int] = PIDS,
    why: Mapping[str, Sequence[str]] = MappingProxyType({}),
) -> str | None:
    """The line about a run that has come to 1 s of simulated time, and has stood still for long."""
    reports = NodeReports("/ev")
    reports.time = 1.0
    for node, whom in waits.items():
        reports._take(node, Word(WAITS, values={"whom": list(whom), "why": [*why.get(node, ())]}))
    hanging = Hanging(reports, pids, 0.0, realtime)
    hanging._since = time.monotonic() - 10.0
    return hanging.look()


@pytest.mark.parametrize(
    ("node", "waits"),
    [
        ("asr", {"plant": ("asr",), "driver": ("plant",)}),
        ("electronic_differential", {"plant": ("asr",), "asr": ("electronic_differential",)}),
        ("asr", {"plant": ("asr",), "asr": ("plant",)}),  # it lives, and no node receives it
        ("recorder", {"plant": ("recorder",), "recorder": ("plant",)}),
        (
            "plant",
            {"driver": ("plant",), "asr": ("electronic_differential",), "recorder": ("plant",)},
        ),
    ],
)
def test_the_end_of_the_chain_is_named(node, waits):
    assert named(waits) == f"node {node} does not answer, at 1 s of simulated time"


def test_reasons_of_waiting_nodes_are_printed():
    """The master looks into the graph, and each node knows which of its messages it has ignored."""
    waits = {"plant": ("asr",), "asr": ("electronic_differential",)}
    late = (
        "torque_request at 1790000000.1 s ignored (reported once): 0.0 s is due, in steps of 0.01 s"
    )
    line = "node electronic_differential does not answer, at 1 s of simulated time"
    assert named(waits, why={"asr": [late]}) == f"{line}: {late}"
    unfit = (
        "/ev/electronic_differential publishes /ev/torque_request as best effort, expected reliable"
    )
    assert named(waits, why={"plant": [unfit], "asr": [late, unfit]}) == f"{line}: {unfit}; {late}"
    assert named(waits, why={"driver": [unfit]}) == line  # which is not waited for


def test_real_time_that_has_not_begun_waits_for_a_node():
    assert "node asr does" in named({"plant": ("asr",)}, realtime=True)


def test_in_real_time_the_recorder_knows():
    assert "node plant does" in named({"recorder": ("plant",)}, realtime=True)
    assert "node recorder does" in named({}, realtime=True)


def test_behind_the_end_of_the_plant_only_the_recorder_is_left():
    assert "node recorder does" in named({"recorder": ("plant",)}, pids={"recorder": 1})


def test_a_run_that_goes_on_or_rests_is_not_named_and_old_reports_do_not_count(
    monkeypatch,
):
    reports = NodeReports("/ev")
    hanging = Hanging(reports, PIDS, 0.0, realtime=False)
    reports.rests, hanging._since = True, time.monotonic() - 100.0
    assert hanging.look() is None
    reports._take("plant", Word(WAITS, values={"whom": ["asr"], "why": []}))
    later = time.monotonic() + 5.0
    monkeypatch.setattr(time, "monotonic", lambda: later)
    assert reports.waits_for("plant", 1.0) is None


def test_a_node_reports_what_it_waits_for_once_its_steps_stand_still(monkeypatch):
    words, now = [], [0.0]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    line = SimpleNamespace(spec=RunnerLine, tell=words.append)
    waiting = Waiting(line)
    for step in range(10):
        now[0] = 0.1 * step
        waiting.look(step, ("plant",))
    assert words == []
    for _ in range(10):
        now[0] += 0.1
        waiting.look(9, ("plant",))
    assert 3 <= len(words) <= 5 and words[0] == Word(WAITS, values={"whom": ["plant"], "why": []})


def test_a_plant_that_waits_for_nothing_but_its_pace_does_not_hang(monkeypatch):
    """Steps of 2.5 s, at `real_time_factor` 0.004, are no silence of the plant."""
    reports, now = NodeReports("/ev"), [0.0]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    plant = object.__new__(MasterNode)
    plant.done, plant._go_on, plant._retry_period = False, lambda: None, 0.05
    plant.configuration = SimpleNamespace(common=SimpleNamespace(mode="lockstep"))
    plant.stepper = SimpleNamespace(inbox=SimpleNamespace(last=10**7, missing=lambda: ()))
    plant.__dict__["schedule"] = SimpleNamespace(
        all_are_here=True, recorder_keeps_up=True, rests=False
    )
    plant._waiting = Waiting(SimpleNamespace(tell=lambda word: reports._take("plant", word)))
    hanging = Hanging(reports, PIDS, 2.0, realtime=False)
    reports.time = 0.01

    def lines_within(seconds: float, idle: bool) -> list[str]:
        lines = []
        for _ in range(round(seconds / 0.05)):
            now[0] += 0.05
            if idle:
                plant.idle()
            lines.append(hanging.look())
        return [line for line in lines if line is not None]

    assert lines_within(60.0, idle=True) == []
    assert lines_within(60.0, idle=False) == [
        "node plant does not answer, at 0.01 s of simulated time"
    ]


@pytest.mark.parametrize(
    ("stopped", "line"),
    [(True, "stopped by a signal: asr, at 0 s of simulated time"), (False, None)],
)
def test_a_node_that_is_stopped_while_nodes_start_is_named_at_once(
    stopped: bool, line: str | None, monkeypatch
):
    """Nodes may take 10 s to start; one that the kernel has stopped does not start."""
    now = [0.0]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    monkeypatch.setattr(processes, "_is_stopped", lambda pid: stopped and pid == 7)
    hanging = Hanging(NodeReports("/ev"), {"plant": 1, "asr": 7}, 2.0, realtime=False)
    now[0] = 1.7
    assert hanging.look() is None
    now[0] = 1.9
    assert hanging.look() == line
