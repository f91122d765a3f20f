"""Watcher of a run: the node that is named when a run stands still, and runs that never begin."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType, SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ev_nodes.master.node import MasterNode
from ev_nodes.stepping.runner_line import WAITS, RunnerLine, Waiting, Word
from ev_stack.recording.outcome import RunFailed
from ev_stack.running import watching
from ev_stack.running.node_reports import NodeReports
from ev_stack.running.watching import RunWatcher, silent_node

NODES = ("plant", "driver", "electronic_differential", "asr", "recorder")
PERIOD = 10_000_000  # ns


@pytest.fixture
def now(monkeypatch):
    """Seconds of the monotonic clock, which the test turns."""
    clock = [100.0]
    monkeypatch.setattr(watching.time, "monotonic", lambda: clock[0])
    return clock


def watcher_of(
    reports: NodeReports,
    nodes: Sequence[str] = NODES,
    realtime: bool = False,
    answer_timeout: float = 2.0,
    patient: bool = False,
) -> RunWatcher:
    """A watcher of nodes with living processes."""
    plant = SimpleNamespace(extra=SimpleNamespace(answer_timeout=answer_timeout))
    run = SimpleNamespace(
        duration=2.0, period=PERIOD, realtime=realtime, configurations={"plant": plant}
    )
    processes = [
        SimpleNamespace(name=name, process=SimpleNamespace(pid=number, poll=lambda: None))
        for number, name in enumerate(nodes, start=2**22)
    ]
    return RunWatcher(run, processes, reports, patient)


def named(
    now: list[float],
    waits: dict[str, tuple[str, ...]],
    realtime: bool = False,
    nodes: Sequence[str] = NODES,
    why: Mapping[str, Sequence[str]] = MappingProxyType({}),
) -> str:
    """The line about a run that has come to 1 s of simulated time, and has stood still for long."""
    reports = NodeReports("/ev")
    watcher = watcher_of(reports, nodes, realtime)
    reports.time = 1.0
    assert watcher.look() == []
    now[0] += 10.0
    for node, whom in waits.items():
        reports._take(node, Word(WAITS, values={"whom": list(whom), "why": [*why.get(node, ())]}))
    (line,) = watcher.look()
    assert watcher.look() == [], "each standstill is named once"
    return line


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
def test_the_end_of_the_chain_is_named(node, waits, now):
    assert named(now, waits) == f"node {node} does not answer, at 1 s of simulated time"


def test_reasons_of_waiting_nodes_are_printed(now):
    """The master looks into the graph, and each node knows which of its messages it has ignored."""
    waits = {"plant": ("asr",), "asr": ("electronic_differential",)}
    late = (
        "torque_request at 1790000000.1 s ignored (reported once): 0.0 s is due, in steps of 0.01 s"
    )
    line = "node electronic_differential does not answer, at 1 s of simulated time"
    assert named(now, waits, why={"asr": [late]}) == f"{line}: {late}"
    unfit = (
        "/ev/electronic_differential publishes /ev/torque_request as best effort, expected reliable"
    )
    assert (
        named(now, waits, why={"plant": [unfit], "asr": [late, unfit]})
        == f"{line}: {unfit}; {late}"
    )
    assert named(now, waits, why={"driver": [unfit]}) == line  # which is not waited for


def test_real_time_that_has_not_begun_waits_for_a_node(now):
    assert "node asr does" in named(now, {"plant": ("asr",)}, realtime=True)


def test_in_real_time_the_recorder_knows(now):
    assert "node plant does" in named(now, {"recorder": ("plant",)}, realtime=True)
    assert "node recorder does" in named(now, {}, realtime=True)


def test_behind_the_end_of_the_plant_only_the_recorder_is_left(now):
    assert "node recorder does" in named(now, {"recorder": ("plant",)}, nodes=["recorder"])


def test_a_run_that_rests_is_not_named_and_old_reports_do_not_count(now):
    reports = NodeReports("/ev")
    watcher = watcher_of(reports)
    reports.rests = True
    now[0] += 100.0
    assert watcher.look() == []
    reports._take("plant", Word(WAITS, values={"whom": ["asr"], "why": []}))
    now[0] += 5.0
    assert reports.waits_for("plant", 1.0) is None


@given(
    waits=st.dictionaries(st.sampled_from(NODES), st.lists(st.sampled_from(NODES), max_size=3)),
    present=st.sets(st.sampled_from(NODES)),
    realtime=st.booleans(),
)
def test_whatever_nodes_wait_for_the_chain_ends_and_each_waits_for_the_next(
    waits, present, realtime
):
    """No report sends the watcher around in a circle, and no node that has ended is named by another one."""
    reports = NodeReports("/ev")
    for node, whom in waits.items():
        reports._take(node, Word(WAITS, values={"whom": whom, "why": []}))
    chain = silent_node(reports, present, realtime)
    assert chain[0] in ("plant", "recorder")
    assert len(set(chain)) == len(chain)
    for node, following in itertools.pairwise(chain):
        assert following in waits[node]
        assert following in present


def test_a_node_reports_what_it_waits_for_once_its_steps_stand_still(now):
    words = []
    line = SimpleNamespace(spec=RunnerLine, tell=words.append)
    waiting = Waiting(line)
    for step in range(10):
        now[0] = 100.0 + 0.1 * step
        waiting.look(step, ("plant",))
    assert words == []
    for _ in range(10):
        now[0] += 0.1
        waiting.look(9, ("plant",))
    assert 3 <= len(words) <= 5 and words[0] == Word(WAITS, values={"whom": ["plant"], "why": []})


def test_a_plant_that_waits_for_nothing_but_its_pace_does_not_hang(now):
    """Steps of 2.5 s, at `real_time_factor` 0.004, are no silence of the plant."""
    reports = NodeReports("/ev")
    plant = object.__new__(MasterNode)
    plant.done, plant._go_on, plant._retry_period = False, lambda: None, 0.05
    plant.configuration = SimpleNamespace(common=SimpleNamespace(mode="lockstep"))
    plant.stepper = SimpleNamespace(inbox=SimpleNamespace(last=10**7, missing=lambda: ()))
    plant.__dict__["schedule"] = SimpleNamespace(
        all_are_here=True, recorder_keeps_up=True, rests=False
    )
    plant._waiting = Waiting(SimpleNamespace(tell=lambda word: reports._take("plant", word)))
    watcher = watcher_of(reports)
    reports.time = 0.01

    def lines_within(seconds: float, idle: bool) -> list[str]:
        lines = []
        for _ in range(round(seconds / 0.05)):
            now[0] += 0.05
            if idle:
                plant.idle()
            lines += watcher.look()
        return lines

    assert lines_within(60.0, idle=True) == []
    assert lines_within(60.0, idle=False) == [
        "node plant does not answer, at 0.01 s of simulated time"
    ]


@pytest.mark.parametrize(
    ("stopped", "lines"),
    [(True, ["stopped by a signal: asr, at 0 s of simulated time"]), (False, [])],
)
def test_a_node_that_is_stopped_while_nodes_start_is_named_at_once(
    stopped: bool, lines: list[str], now, monkeypatch
):
    """Nodes may take 10 s to start; one that the kernel has stopped does not start."""
    second = 2**22 + 1
    monkeypatch.setattr(watching, "is_stopped", lambda pid: stopped and pid == second)
    watcher = watcher_of(NodeReports("/ev"), ["plant", "asr"])
    now[0] += 1.7
    assert watcher.look() == []
    now[0] += 0.2
    assert watcher.look() == lines


def ended_after(watcher: RunWatcher, now: list[float], most: float) -> float:
    """Seconds until the run is given up, infinite if it is not for so long."""
    start = now[0]
    while now[0] < start + most:
        try:
            watcher.look()
        except RunFailed as error:
            assert str(error).startswith("no step was taken within 300 s: the nodes do not find")
            return now[0] - start
        now[0] += 1.0
    return math.inf


def test_a_run_of_our_own_nodes_that_takes_no_step_ends_in_one_line(now):
    """The middleware lets no node find another one, say."""
    assert ended_after(watcher_of(NodeReports("/ev")), now, 400.0) == pytest.approx(300.0, abs=2.0)


@pytest.mark.parametrize("how", ["nodes of others", "rests", "has begun"])
def test_a_run_that_may_still_go_on_is_not_given_up(how, now):
    """A node of others may load for long or be debugged; a service may have stopped time."""
    reports = NodeReports("/ev")
    watcher = watcher_of(reports, patient=how == "nodes of others")
    reports.rests = how == "rests"
    reports.time = 0.01 if how == "has begun" else 0.0
    assert ended_after(watcher, now, 400.0) == math.inf


def ending_node(name: str, code: int | None) -> SimpleNamespace:
    process = SimpleNamespace(pid=2**22, returncode=code, poll=lambda: code)
    return SimpleNamespace(name=name, process=process, failure=lambda: f"node {name} has failed")


@pytest.mark.parametrize(("name", "code"), [("asr", 0), ("plant", 1), ("recorder", -9)])
def test_a_node_that_ends_before_the_run_does_is_named(name, code, now):
    watcher = watcher_of(NodeReports("/ev"))
    watcher._nodes = [ending_node(name, code)]
    with pytest.raises(RunFailed, match=f"^node {name} has failed, at 0 s of simulated time$"):
        watcher.notice_ends()


def test_a_run_is_over_when_plant_and_recorder_have_ended(now):
    """The last reports of a node may come two seconds after its end."""
    reports = NodeReports("/ev")
    watcher = watcher_of(reports)
    watcher._nodes = [ending_node("plant", 0), ending_node("recorder", None)]
    watcher.look()
    reports.time = 1.0
    now[0] += 1.0
    watcher.look()
    watcher.notice_ends()
    assert not watcher.is_over
    watcher._nodes[1] = ending_node("recorder", 0)
    reports.time = watcher.last
    now[0] += 1.0
    watcher.look()
    watcher.notice_ends()
    assert watcher.is_over
    assert watcher.wall_time == pytest.approx(2.0)


def test_a_recorder_that_lacks_the_end_is_named_after_two_seconds(now):
    reports = NodeReports("/ev")
    watcher = watcher_of(reports)
    watcher._nodes = [ending_node("plant", 0), ending_node("recorder", None)]
    reports.time = 1.0
    watcher.look()
    watcher.notice_ends()
    now[0] += 1.9
    watcher.notice_ends()
    now[0] += 0.2
    with pytest.raises(RunFailed, match=r"^node plant has failed, at 1 s of simulated time$"):
        watcher.notice_ends()
