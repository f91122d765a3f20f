"""Pause, resume, single step and reset: time stands still or restarts, and no number changes."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from helpers.ros_graph import NODES, SERVICES, Graph, graph, offline_hash, recorded_hash, shchur
from hypothesis import example, given, settings
from hypothesis import strategies as st
from rclpy.parameter import Parameter
from rosbags.highlevel import AnyReader

from ev_msgs_py.contract.signals import WheelStates
from ev_msgs_py.contract.stamps import to_seconds
from ev_stack.scenarios.scenario import Overrides, Run, load_scenario

pytestmark = pytest.mark.slow

DURATION = 0.8
SHORT = 0.1  # s
RUN = shchur(DURATION, plant__real_time_factor=1.0)
PERIOD = 0.01


@pytest.fixture
def nodes(tmp_path) -> Iterator[Graph]:
    """A graph with callable services; the driver, without which time stands at zero, comes last."""
    with graph(
        RUN, tmp_path, bag=True, names=[name for name in NODES if name != "driver"]
    ) as nodes:
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
    assert nodes.time <= paused_at + PERIOD, (
        "the step that was under way may end, the other was taken back"
    )


def test_a_granted_step_waits_for_a_node_that_joins(nodes):
    nodes.call("pause")
    nodes.run_rounds()
    paused_at = nodes.time
    nodes.kill("driver")
    nodes.call("step")
    nodes.call("step")
    nodes.start("driver")
    nodes.run(lambda: nodes.time == pytest.approx(paused_at + 2 * PERIOD, abs=1e-12))


def test_reset_restarts_the_run_for_all_nodes(nodes, tmp_path):
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
            stamps[name] = [
                stamp
                for connection, stamp, _ in bag.messages()
                if connection.topic == "/ev/wheel_states"
            ]
    steps = round(DURATION / PERIOD)
    assert stamps["bag"] == [step * 10_000_000 for step in range(steps + 1)]
    assert stamps["bag_before_reset_1"] == [
        step * 10_000_000 for step in range(len(stamps["bag_before_reset_1"]))
    ]
    assert 30 <= len(stamps["bag_before_reset_1"]) <= steps


# Actions on the live page: services, and parameters of what integrates and of what
# answers.
CHANGED = {
    "plant.initial_speed": st.floats(10.0, 20.0),
    "steering_column.dry_friction": st.floats(0.0, 0.5),
    "driver.speed_control.proportional_gain": st.floats(100.0, 900.0),
    "electronic_differential.gamma": st.floats(1.0, 20.0),
}
words = st.one_of(
    st.sampled_from(SERVICES),
    st.sampled_from(SERVICES),
    *(st.tuples(st.just(name), values) for name, values in CHANGED.items()),
)


def lane_change(values: dict[str, float]) -> Run:
    """A tenth of a second of it; a step takes half a second unless a test sets another pace."""
    given = [(*name.split(".", 1), value) for name, value in values.items()]
    given += [
        ("plant", "real_time_factor", 0.02),
        ("electronic_differential", "method", "power_steering"),
    ]
    return load_scenario("double_lane_change", Overrides(values=given, duration=SHORT)).runs[0]


def changed(nodes: Graph, name: str, value: float) -> None:
    role, _, parameter = name.partition(".")
    result = nodes.nodes[role].set_parameters_atomically([Parameter(parameter, value=value)])
    assert result.successful, result.reason


VIEWS = (
    "/tf",
    "/tf_static",
    "/parameter_events",
    "/ev/odometry",
    "/ev/robot_description",
    "/ev/tyre_force_markers",
)


def assert_bags_hold_one_run_each(folder: Path) -> None:
    """Check that every topic begins at the first instant and has no gap."""
    bags = sorted(path for path in folder.iterdir() if path.name.startswith("bag"))
    for path in bags:
        stamps: dict[str, list[int]] = {}
        with AnyReader([path]) as bag:
            for connection, stamp, _ in bag.messages():
                stamps.setdefault(connection.topic, []).append(stamp)
        for view in ("/diagnostics", *VIEWS):  # not of every step
            stamps.pop(view, None)
        for topic, came in stamps.items():
            assert came == [step * 10_000_000 for step in range(len(came))], (path.name, topic)
        if path.name == "bag":
            assert {len(came) for came in stamps.values()} == {round(SHORT / PERIOD) + 1}


@pytest.mark.weekly
@settings(max_examples=5)
@given(st.lists(words, max_size=8))
@example(["pause", "reset", ("plant.initial_speed", 15.0)])
@example(["pause", "step", "reset", ("electronic_differential.gamma", 9.0), "step", "reset"])
def test_services_and_changes_in_any_order_end_in_a_fresh_run_with_the_same_values(
    tmp_path_factory: pytest.TempPathFactory, words: list
):
    """Values agree to the bit, and every bag holds one run.

    That holds at time zero as well, and where resets follow each other.
    """
    folder, values = tmp_path_factory.mktemp("run"), {}
    (folder / "bag_before_reset_1").mkdir()  # of the user's own
    with graph(
        lane_change({}), folder, bag=True, names=[name for name in NODES if name != "driver"]
    ) as nodes:
        nodes.run(nodes.can_be_called)
        nodes.start("driver")
        nodes.call("pause")
        for word in words:
            if isinstance(word, str):
                nodes.call(word)
            else:
                changed(nodes, *word)
                values[word[0]] = word[1]
        nodes.call("reset")
        nodes.call("resume")
        changed(nodes, "plant.real_time_factor", 0.0)
        nodes.run()
    assert recorded_hash(folder) == offline_hash(lane_change(values))
    assert not any((folder / "bag_before_reset_1").iterdir())
    (folder / "bag_before_reset_1").rmdir()
    assert_bags_hold_one_run_each(folder)
