"""Pause, resume, single step and reset: time stands still or begins anew, and no number changes."""

from collections.abc import Iterator

import pytest
from ros_graph import NODES, Graph, graph, offline_hash, recorded_hash, shchur
from rosbags.highlevel import AnyReader

from ev_msgs_py.contract.signals import WheelStates
from ev_msgs_py.contract.stamps import to_seconds

pytestmark = pytest.mark.slow

DURATION = 0.8
RUN = shchur(DURATION, plant__real_time_factor=1.0)
PERIOD = 0.01


@pytest.fixture
def nodes(tmp_path) -> Iterator[Graph]:
    """A graph whose services can be called: the driver, without whom time stands at zero, comes last."""
    with graph(RUN, tmp_path, bag=True, names=[name for name in NODES if name != "driver"]) as nodes:
        nodes.run(nodes.can_be_called)
        nodes.start("driver")
        yield nodes


def test_pause_stops_time_and_resume_lets_it_go_on(nodes, tmp_path):
    nodes.run(lambda: nodes.time >= 0.2)
    assert nodes.call("pause") == f"paused at {nodes.time} s"
    paused_at = nodes.time
    assert 0.2 <= paused_at < DURATION
    nodes.run_rounds()
    assert nodes.time == paused_at
    nodes.call("resume")
    nodes.run()
    assert recorded_hash(tmp_path) == offline_hash(RUN)


def test_each_step_is_one_period(nodes, tmp_path):
    nodes.call("pause")
    heard = nodes.probe.listen(WheelStates)
    paused_at = nodes.time
    for _ in range(3):
        nodes.call("step")
    nodes.run(lambda: nodes.time >= paused_at + 2.5 * PERIOD)
    nodes.run_rounds()  # and no further
    assert nodes.time == pytest.approx(paused_at + 3 * PERIOD, abs=1e-12)
    assert max(to_seconds(stamp) for stamp, _ in heard) == nodes.time
    nodes.call("resume")
    nodes.run()
    assert recorded_hash(tmp_path) == offline_hash(RUN)


def test_pause_takes_back_steps_that_were_granted(nodes):
    """Granted while a node is missing, they cannot be taken yet."""
    nodes.call("pause")
    nodes.run_rounds()
    paused_at = nodes.time
    nodes.kill("asr")
    nodes.call("step")
    nodes.call("step")
    nodes.call("pause")
    nodes.start("asr")
    nodes.run_rounds()
    assert nodes.time <= paused_at + PERIOD, "the step that was under way may end, the other was taken back"


def test_a_granted_step_waits_for_a_node_that_joins(nodes):
    nodes.call("pause")
    nodes.run_rounds()
    paused_at = nodes.time
    nodes.kill("driver")
    nodes.call("step")
    nodes.call("step")
    nodes.start("driver")
    nodes.run(lambda: nodes.time == pytest.approx(paused_at + 2 * PERIOD, abs=1e-12))


def test_reset_begins_the_run_anew_for_everybody(nodes, tmp_path):
    nodes.run(lambda: nodes.time >= 0.3)
    assert nodes.call("reset") == "time is zero again, at 0.0 s"
    nodes.run()
    assert recorded_hash(tmp_path) == offline_hash(RUN)
    assert nodes.probe.reports == []


def test_reset_at_the_first_instants_changes_nothing(nodes, tmp_path):
    for _ in range(3):
        nodes.call("reset")
    nodes.run()
    assert recorded_hash(tmp_path) == offline_hash(RUN)


def test_a_paused_run_that_is_reset_waits_at_zero(nodes, tmp_path):
    nodes.run(lambda: nodes.time >= 0.2)
    nodes.call("pause")
    nodes.call("reset")
    nodes.run_rounds()
    assert nodes.time == 0.0
    nodes.call("resume")
    nodes.run()
    assert recorded_hash(tmp_path) == offline_hash(RUN)


def test_after_a_reset_the_bag_holds_the_new_run_and_the_old_one_is_kept(nodes, tmp_path):
    nodes.run(lambda: nodes.time >= 0.3)
    nodes.call("reset")
    nodes.run()
    stamps = {}
    for name in ("bag", "bag_before_reset_1"):
        with AnyReader([tmp_path / name]) as bag:
            stamps[name] = [stamp for connection, stamp, _ in bag.messages() if connection.topic == "/ev/wheel_states"]
    steps = round(DURATION / PERIOD)
    assert stamps["bag"] == [step * 10_000_000 for step in range(steps + 1)]
    assert stamps["bag_before_reset_1"] == [step * 10_000_000 for step in range(len(stamps["bag_before_reset_1"]))]
    assert 30 <= len(stamps["bag_before_reset_1"]) <= steps
