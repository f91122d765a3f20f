"""All nodes in one process over DDS have the numbers of offline, whichever come and go."""

import math
from pathlib import Path
from typing import Any

import pytest
from helpers.ros_graph import (
    NAMESPACE,
    NODES,
    WAYS,
    Graph,
    Probe,
    graph,
    offline_hash,
    publisher,
    recorded_hash,
    ros_domain,
    shchur,
)
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy

from ev_core.sensors.row import QUANTITIES
from ev_msgs_py.contract.frame import Frame, numbers_of
from ev_msgs_py.contract.roles import REQUIRED
from ev_msgs_py.contract.signals import WheelTorqueCommand
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.wire import format_of, message_class
from ev_nodes.master.node import MasterNode
from ev_nodes.stepping.signal_io import QUALITY
from ev_nodes.stepping.spinning import spin
from ev_stack.recording.recording import load
from ev_stack.running.offline import RECORDER
from ev_stack.scenarios.scenario import Overrides, Run, load_scenario

pytestmark = pytest.mark.slow


class Printed:
    """Log of the nodes since this was made."""

    def __init__(self, capture: pytest.CaptureFixture) -> None:
        capture.readouterr()
        self._capture = capture
        self.text = ""

    def until_now(self) -> str:
        self.text += self._capture.readouterr().err
        return self.text


def complete(run: Run, directory: Path, nodes: Graph) -> None:
    """Run to the end, and compare with the offline runner."""
    nodes.run()
    assert recorded_hash(directory) == offline_hash(run)


@pytest.mark.parametrize("way", WAYS.values(), ids=WAYS)
def test_the_graph_gives_the_same_numbers_as_the_offline_runner(way, tmp_path):
    run = shchur(0.5)
    with graph(run, tmp_path) as nodes:
        nodes.run(way=way)
        assert nodes.probe.reports == []
    assert recorded_hash(tmp_path) == offline_hash(run)


def test_a_stranger_on_every_topic_changes_nothing_and_is_named_once_by_each_node(tmp_path):
    """It repeats every stamp with other numbers, and NaN, from before the first step on."""
    run = shchur(1.0)
    with graph(run, tmp_path) as nodes:
        stranger = Node("stranger", context=nodes.context, namespace=NAMESPACE)
        mouths = [
            (format_of(signal), publisher(stranger, topic)) for signal, topic in TOPICS.items()
        ]
        other = Frame()

        def says_what_it_likes() -> bool:
            for number in (7.0, math.nan):
                other.numbers[:] = numbers_of([number] * len(other.numbers))
                for format_, mouth in mouths:
                    mouth.handle.publish_raw(format_.pack(nodes.nodes["plant"].now, other))
            return nodes.nodes[RECORDER].done

        nodes.run(says_what_it_likes)
        reports = nodes.probe.reports
    assert recorded_hash(tmp_path) == offline_hash(run)
    assert {report.partition(": ")[2].partition(" is refused: ")[0] for report in reports} == {
        "/ev/stranger"
    }
    named_by = [report.partition(": ")[0] for report in reports]
    assert len(named_by) == len(set(named_by)) and {"/ev/plant", "/ev/recorder"} <= set(named_by)


def test_sensors_show_the_same_over_dds_as_offline(tmp_path):
    """Noise, bias, quantisation, delay and drop-out in every sensor of plant and column.

    The seed decides.
    """
    errors = {"noise": 0.01, "bias": -0.01, "quantisation": 1e-3, "delay": 2, "dropout": 0.1}
    values = {
        f"{role}__sensors.{quantity.name}.{error}": value
        for role, configuration in shchur(1.0).configurations.items()
        for quantity in QUANTITIES
        if quantity.signal in configuration.method.writes
        for error, value in errors.items()
    }
    assert {name.split("__")[0] for name in values} == {"plant", "steering_column"}
    run = shchur(1.0, plant__seed=4, steering_column__seed=4, **values)
    with graph(run, tmp_path) as nodes:
        nodes.run()
    recorded = recorded_hash(tmp_path)
    assert recorded == offline_hash(run)
    assert recorded != offline_hash(shchur(1.0, plant__seed=5, steering_column__seed=4, **values))


def test_equal_hashes_say_something():
    """Hashes that are always equal would prove nothing.

    A virtual spring that is one part in 10^12 softer shows.
    """
    softer = shchur(12.0, electronic_differential__k_ck=0.051 * (1 - 1e-12))
    assert offline_hash(shchur(12.0)) == offline_hash(shchur(12.0)) != offline_hash(softer)


@pytest.mark.parametrize("late", NODES)
@pytest.mark.sampled
def test_everybody_waits_for_a_node_that_starts_late(late, tmp_path):
    run = shchur(0.3)
    with graph(run, tmp_path, names=[name for name in NODES if name != late]) as nodes:
        nodes.run_rounds()
        nodes.start(late)
        complete(run, tmp_path, nodes)
        assert nodes.probe.reports == []


@pytest.mark.parametrize("dead", [name for name in REQUIRED if name != "plant"])
@pytest.mark.sampled
def test_the_master_names_a_dead_node_and_goes_on_with_its_successor(dead, tmp_path, capfd):
    run = shchur(0.5, plant__answer_timeout=0.2, plant__real_time_factor=1.0)
    with graph(run, tmp_path) as nodes:
        nodes.run(lambda: nodes.time >= 0.2)
        nodes.kill(dead)
        printed = Printed(capfd)
        nodes.run(lambda: "ERROR" in printed.until_now())
        assert f"not in the graph: {dead}\n" in printed.text
        assert nodes.time < 0.5
        nodes.start(dead)
        nodes.run()
        assert [
            report
            for report in nodes.probe.reports
            if "joined" in report and "not reproducible" in report
        ]
    assert load(tmp_path / "signals.npz").duration == 0.5


def test_the_master_says_that_it_waits_for_the_recorder(tmp_path, capfd):
    """The recorder holds back the end, else the last steps could be lost."""
    run = shchur(0.5, plant__answer_timeout=0.2)
    with graph(run, tmp_path, names=REQUIRED) as nodes:
        printed = Printed(capfd)
        nodes.run(lambda: "waiting for the recorder at 0.0 s" in printed.until_now())
        assert nodes.time == 0.0


def the_rest_of(nodes: Graph, quality: Any) -> tuple[Node, Any]:
    """A user's traction control in a graph without one, and its publisher if it has one."""
    own = Node("asr", context=nodes.context, namespace=NAMESPACE)
    topic = TOPICS[WheelTorqueCommand]
    return own, quality and own.create_publisher(
        message_class(topic.message_type), topic.name, quality
    )


@pytest.mark.parametrize(
    ("quality", "why"),
    [
        (None, "asr has no publisher of torque_command"),
        (QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT), "expected reliable"),
        (QoSProfile(depth=1), "all nodes are in the graph, one does not answer"),
    ],
    ids=["no publisher", "best effort", "silent"],
)
def test_the_master_says_why_nothing_comes_of_a_node_that_is_there(quality, why, tmp_path, capfd):
    run = shchur(0.5, plant__answer_timeout=0.2)
    with graph(run, tmp_path, names=[name for name in NODES if name != "asr"]) as nodes:
        own, _ = the_rest_of(nodes, quality)
        printed = Printed(capfd)
        nodes.run(lambda: f"{why}\n" in printed.until_now())
        own.destroy_node()
    assert "WheelTorqueCommand of asr at 0.0 s" in printed.text


def test_the_master_reports_a_command_stamped_by_the_time_of_day(tmp_path):
    """The commonest mistake in a node of one's own."""
    run = shchur(0.5)
    with graph(run, tmp_path, names=[name for name in NODES if name != "asr"]) as nodes:
        own, mouth = the_rest_of(nodes, QUALITY)
        late = format_of(WheelTorqueCommand).pack(1_790_000_000_123_456_789, Frame())

        def reported() -> bool:
            mouth.handle.publish_raw(late)
            return bool(nodes.probe.reports)

        nodes.run(reported)
        own.destroy_node()
    expected = (
        "/ev/plant: torque_command at 1790000000.1234567 s ignored (reported once): 0.0 s is due"
    )
    assert nodes.probe.reports[0].startswith(expected)


CARS = "car1", "car2"


def clocks(context: Any, *words: str) -> list[Node]:
    """The masters of two cars in one domain."""
    spaces = [["-r", f"__ns:=/{car}"] for car in CARS]
    return [
        MasterNode(context=context, cli_args=["--ros-args", *space, *words]) for space in spaces
    ]


def test_two_masters_on_one_clock_name_each_other():
    with ros_domain() as context:
        probe, nodes = Probe(context), clocks(context)

        def named() -> bool:
            probe.look()
            return len(probe.reports) == 2

        spin(nodes, named)
    assert sorted(probe.reports) == [
        "/car1/plant: /car2/plant publishes /clock as well; -r /clock:=clock lets each have its own",
        "/car2/plant: /car1/plant publishes /clock as well; -r /clock:=clock lets each have its own",
    ]


def test_by_the_rule_that_a_master_names_each_car_has_a_clock_of_its_own():
    with ros_domain() as context:
        nodes = clocks(context, "-r", "/clock:=clock")
        found = [
            [end.node_namespace for end in nodes[0].get_publishers_info_by_topic(f"/{car}/clock")]
            for car in CARS
        ]
    assert found == [["/car1"], ["/car2"]]


def test_a_restarted_master_restarts_the_run(tmp_path):
    run = shchur(0.5, plant__real_time_factor=1.0)
    with graph(run, tmp_path) as nodes:
        nodes.run(lambda: nodes.time >= 0.2)
        nodes.kill("plant")
        assert not nodes.nodes[RECORDER].done
        nodes.start("plant")
        complete(run, tmp_path, nodes)


@pytest.mark.weekly
@pytest.mark.parametrize(
    ("driver", "differential", "asr"),
    [
        ("pulse", "adaptive", "least_squares"),
        ("imposed_speed", "adhesion_share", "pi_slip"),
        ("tracking", "limited_slip_variable", "speed_by_slip"),
    ],
)
def test_the_urban_cycle_is_the_same_over_dds(driver, differential, asr, tmp_path):
    """20 s of it, of which the last four pull away on snow.

    The speed is imposed where the driver needs that.
    """
    values = [
        ("*", "control_period", 0.01),
        ("driver", "method", driver),
        ("electronic_differential", "method", differential),
        ("asr", "method", asr),
        ("plant", "speed", "imposed" if driver == "imposed_speed" else "free"),
        ("plant", "method", "planar"),
    ]
    (run,) = load_scenario("urban_mixed", Overrides((), values, 20.0)).runs
    with graph(run, tmp_path) as nodes:
        complete(run, tmp_path, nodes)
    assert load(tmp_path / "signals.npz").channels["twist.longitudinal"][-1] > 2.0


def test_the_recorder_names_the_topics_on_which_nothing_comes(tmp_path, monkeypatch):
    """A graph without traction control waits; once that has joined, the run is the offline one."""
    monkeypatch.setattr("ev_stack.recorder_node._LONG", 0.1)
    run = shchur(0.2)
    with graph(run, tmp_path, names=[name for name in NODES if name != "asr"]) as nodes:
        nodes.run(
            lambda: any(
                "recorder: nothing has come on torque_command" in text
                for text in nodes.probe.reports
            )
        )
        nodes.start("asr")
        complete(run, tmp_path, nodes)


@pytest.mark.weekly
def test_the_recorder_names_no_topic_behind_a_reset_in_which_time_rests(tmp_path, monkeypatch):
    """Answers to the new first instant may come with those of the run before, and be dropped."""
    monkeypatch.setattr("ev_stack.recorder_node._LONG", 0.5)
    run = shchur(0.1, plant__real_time_factor=0.1)
    with graph(run, tmp_path) as nodes:
        nodes.run(lambda: nodes.time >= 0.06 and nodes.can_be_called())
        for service in ("pause", *["reset", "step"] * 10, "reset", "resume"):
            nodes.call(service)
        complete(run, tmp_path, nodes)
        assert not [text for text in nodes.probe.reports if "nothing has come" in text]
