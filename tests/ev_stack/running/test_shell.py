"""A running graph from a shell without the ros2 command.

What there is, messages, parameters, time.
"""

import io
import os
import re
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from importlib.metadata import version
from types import SimpleNamespace

import pytest
import rclpy
import yaml
from geometry_msgs.msg import Point
from helpers.ros_graph import NAMESPACE, NODES
from helpers.run_script import ENVIRONMENT, ROOT, Running
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from ev_msgs_py.contract.roles import RECORDED
from ev_msgs_py.contract.topics import TOPICS
from ev_nodes.stepping.stop_request import KEPT
from ev_stack.commands import live_graph, present_graph
from ev_stack.commands.program import perform
from ev_stack.running.domain import free_domain

pytestmark = pytest.mark.slow


def inspect(domain: int, *words: str) -> subprocess.CompletedProcess:
    environment = {**ENVIRONMENT, "ROS_DOMAIN_ID": str(domain)}
    command = [ROOT / "scripts" / "inspect.sh", *words]
    return subprocess.run(command, env=environment, capture_output=True, text=True)


@pytest.fixture(scope="module")
def domain(tmp_path_factory) -> Iterator[int]:
    """Domain of a graph held at a fifth of real time, in one process, cheap for others."""
    running = Running(
        tmp_path_factory.mktemp("inspect") / "out",
        "--in-process",
        "--set",
        "plant.real_time_factor=0.2",
    )
    yield int(re.search(r"ROS_DOMAIN_ID=(\d+), namespace /ev\n", running.text())[1])
    os.killpg(running.script.pid, signal.SIGINT)
    running.end()


def test_it_shows_nodes_topics_ends_and_rates(domain):
    shown = inspect(domain, "--seconds", "0.5").stdout
    nodes, _, topics = shown.partition("\n\n")
    assert {line.strip() for line in nodes.splitlines()[1:]} >= {
        f"{NAMESPACE}/{name}" for name in NODES
    }
    written = set(re.findall(rf"^  {NAMESPACE}/(\S+)  ", topics, re.MULTILINE))
    assert written <= {topic.name for topic in TOPICS.values()}
    for name in (
        "wheel_states",
        "driver/command",
        "torque_request",
        "torque_command",
        "steering_column/state",
    ):
        kind, rate = re.search(
            rf"^  {NAMESPACE}/{name}  (\S+)  ([\d.]+) Hz$", topics, re.MULTILINE
        ).groups()
        assert kind == next(topic.message_type for topic in TOPICS.values() if topic.name == name)
        assert float(rate) > 0.0
    assert re.search(
        r"/ev/torque_request .*\n    electronic_differential -> asr, recorder\n", topics
    )
    assert "inspect_graph" not in shown


def test_topics_that_this_car_does_not_have_are_not_shown(domain):
    """The kinematic plant knows no tyre forces."""
    shown = inspect(domain, "--seconds", "0.1").stdout
    assert "tire_forces" in {TOPICS[signal].name for signal in RECORDED}
    assert "tire_forces" not in shown


def test_it_echoes_a_message(domain):
    shown = inspect(domain, "--echo", "/ev/driver/command")
    assert shown.returncode == 0
    message = yaml.safe_load(shown.stdout)
    assert message["name"] == ["drive", "brake", "steering_wheel"] and len(message["effort"]) == 3
    assert message["header"]["frame_id"] == "base_link"


class Shell:
    """`ev-stack` in this process, for the graph of a domain."""

    def __init__(self, capsys):
        self._capsys = capsys

    def __call__(self, *words: str) -> str:
        self._capsys.readouterr()
        perform(words)
        return self._capsys.readouterr().out

    def refused(self, *words: str) -> str:
        with pytest.raises(SystemExit) as ended:
            perform(words)
        assert "\n" not in ended.value.code
        return ended.value.code


@pytest.fixture
def shell(domain, monkeypatch, capsys) -> Iterator[Shell]:
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    yield Shell(capsys)
    assert KEPT, "the participant would be deleted, which may wait for ever"
    KEPT.clear()


def test_the_commands_of_the_readme_for_a_running_graph_work(shell):
    """They run as printed while a run is under way; their change is set back."""
    block = (
        (ROOT / "README.md")
        .read_text()
        .partition("### Look into a running graph")[2]
        .partition("\n### ")[0]
    )
    words = [each.split()[1:] for each in re.findall(r"^ev-stack .*$", block, re.MULTILINE)]
    outputs = [
        "/ev/wheel_states",
        "name: [front_left, ",
        "electronic_differential.gamma: 5.0 -> ",
        "paused",
        "running",
    ]
    for command, expected in zip(words, outputs, strict=True):
        assert expected in shell(*command)
    shell("param", "set", "electronic_differential", "gamma", "5.0")


class FirstLine(io.StringIO):
    """A file that interrupts the writer of a line."""

    def write(self, text: str) -> int:
        super().write(text)
        if "\n" in text:
            raise KeyboardInterrupt
        return len(text)


def test_time_is_stopped_and_stepped_from_a_shell(shell, monkeypatch):
    """A step of the graph is 10 ms.

    Standing still, the plant repeats nothing and no node goes on.
    """
    assert re.fullmatch(r"paused at \S+ s\n", shell("pause"))
    before, _ = (float(re.search(r"at (\S+) s", shell(word))[1]) for word in ("pause", "pause"))
    assert "one more step granted" in shell("step", "3")
    assert float(re.search(r"at (\S+) s", shell("pause"))[1]) == pytest.approx(before + 0.03)
    with monkeypatch.context() as patched:
        patched.setattr(sys, "stderr", FirstLine())
        patched.setattr("ev_stack.commands.shell._SILENCE", 0.2)
        assert shell("topic", "echo", "wheel_states", "--once") == ""  # which waited without a word
        assert (
            "/ev/wheel_states: no message within 0.2 s; simulated time stands still"
            in sys.stderr.getvalue()
        )
    assert shell("reset") == "time is zero again, at 0.0 s\n"
    assert shell("resume") == "running at 0.0 s\n"
    message = yaml.safe_load(shell("topic", "echo", "wheel_states", "--once"))
    assert message["name"][0] == "front_left" and len(message["position"]) == 4


def test_parameters_are_shown_set_and_dumped_as_yaml(shell):
    assert yaml.safe_load(shell("param", "get", "plant", "vehicle.driven_wheels")) == [
        "front_left",
        "front_right",
    ]
    assert (
        shell("param", "set", "plant", "real_time_factor", "0.5")
        == "plant.real_time_factor: 0.2 -> 0.5\n"
    )
    assert shell("param", "get", "plant", "real_time_factor") == "0.5\n"
    file = yaml.safe_load(shell("param", "dump"))
    assert set(file) == {f"{NAMESPACE}/{name}" for name in NODES}
    assert file["/ev/plant"]["ros__parameters"]["real_time_factor"] == 0.5
    assert file["/ev/driver"]["ros__parameters"] == yaml.safe_load(shell("param", "get", "driver"))


def test_topics_are_listed_measured_and_described_as_ros2_does(shell):
    assert "/ev/wheel_states\n" in shell("topic", "list")
    assert "/ev/wheel_states [sensor_msgs/msg/JointState]\n" in shell("topic", "list", "-t")
    assert re.fullmatch(
        r"average rate: \d+\.\d Hz\n", shell("topic", "hz", "wheel_states", "--seconds", "0.5")
    )
    count, ends = (shell("topic", "info", "wheel_states", *words) for words in ((), ("-v",)))
    assert re.match(
        r"Type: sensor_msgs/msg/JointState\nPublisher count: 1\nSubscription count: \d\n", count
    )
    assert "Publisher count: 1\n  /ev/plant: reliable, volatile\n" in ends
    assert "no topic '/ev/nothing'; known: " in shell.refused("topic", "info", "nothing")


def test_parameters_are_listed_and_options_may_stand_behind_the_verb(shell):
    listed = shell("param", "list", "plant", "--namespace", "/ev")
    assert listed.startswith("/ev/plant:\n  ") and "  real_time_factor\n" in listed
    assert shell("param", "list").count(":\n") == len(NODES)


def test_an_absolute_name_needs_no_graph_to_be_chosen(shell, monkeypatch):
    """Two cars in a domain have no single master of time."""

    def several(*_):
        raise LookupError("several are there")

    monkeypatch.setattr("ev_stack.commands.shell.master_namespace", several)
    assert set(yaml.safe_load(shell("topic", "echo", "/clock", "--once"))["clock"]) == {
        "sec",
        "nanosec",
    }
    assert "several are there" in shell.refused("topic", "echo", "wheel_states")


@pytest.fixture
def own_node(domain) -> Iterator[Node]:
    """A node of another program in the graph."""
    context = Context()
    rclpy.init(context=context, domain_id=domain)
    node = Node("own", context=context, namespace=NAMESPACE)
    yield node
    # it would be found before the others by the next test, and taken for the whole graph
    node.destroy_node()
    context.try_shutdown()


def test_a_topic_with_another_type_as_well_is_read_with_ours(shell, own_node):
    """The other type comes first in the alphabet.

    Of a topic that is not ours neither type can be preferred.
    """
    own_node.create_publisher(Point, "wheel_states", 1)
    others = [
        own_node.create_publisher(Point, "own", 1),
        own_node.create_publisher(Point, "other/wheel_states", 1),
    ]
    message = yaml.safe_load(shell("topic", "echo", "wheel_states", "--once"))
    assert message["name"][0] == "front_left"
    types = "sensor_msgs/msg/JointState, geometry_msgs/msg/Point"
    assert f"/ev/wheel_states [{types}]\n" in shell("topic", "list", "-t")
    ends = shell("topic", "info", "-v", "wheel_states")
    assert f"Type: {types}\n" in ends
    assert "  /ev/own: reliable, volatile, geometry_msgs/msg/Point\n" in ends
    assert shell("topic", "info", others[0].topic_name).startswith(
        "Type: geometry_msgs/msg/Point\n"
    )


def test_several_types_none_of_which_is_ours_are_named():
    """The middleware keeps them apart, and a command can read one of them only."""
    types = ["std_msgs/msg/String", "geometry_msgs/msg/Point"]
    node = SimpleNamespace(get_topic_names_and_types=lambda: [("/ev/own", types)])
    with pytest.raises(
        LookupError, match="/ev/own has several types, expected one: std_msgs/msg/String, geometry"
    ):
        present_graph.type_of(node, "/ev/own")


@pytest.mark.parametrize(
    "quality",
    [
        QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT),
        QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL),
    ],
    ids=["best effort", "transient local"],
)
def test_a_message_is_shown_whatever_its_quality_of_service(shell, own_node, quality):
    """One of transient local durability was published once, before anybody subscribed."""
    publisher = own_node.create_publisher(Point, "own", quality)
    publisher.publish(Point(x=3.0))
    if quality.durability is not DurabilityPolicy.TRANSIENT_LOCAL:
        own_node.create_timer(0.02, lambda: publisher.publish(Point(x=3.0)))
    executor = SingleThreadedExecutor(context=own_node.context)
    executor.add_node(own_node)
    publishing = threading.Thread(target=executor.spin)
    publishing.start()
    try:
        assert yaml.safe_load(shell("topic", "echo", "own", "--once")) == {
            "x": 3.0,
            "y": 0.0,
            "z": 0.0,
        }
    finally:
        executor.shutdown()
        publishing.join()


def test_nodes_are_listed_and_described_as_ros2_does(shell):
    assert "/ev/driver\n/ev/electronic_differential\n/ev/plant\n" in shell("node", "list")
    about = shell("node", "info", "asr")
    subscribers, publishers, services = (
        re.search(rf"^  {what}:\n((?:    .*\n)*)", about, re.MULTILINE)[1]
        for what in ("Subscribers", "Publishers", "Service Servers")
    )
    assert about.startswith("/ev/asr\n")
    assert "/ev/torque_request: sensor_msgs/msg/JointState" in subscribers
    assert "/ev/torque_command: sensor_msgs/msg/JointState" in publishers
    assert "/ev/asr/get_parameters: rcl_interfaces/srv/GetParameters" in services
    assert "no node '/ev/unknown'; there are /ev/asr, " in shell.refused("node", "info", "unknown")


def test_a_parameter_is_described_with_what_is_expected(shell):
    about = yaml.safe_load(shell("param", "describe", "plant", "real_time_factor"))
    assert about["value"] == yaml.safe_load(shell("param", "get", "plant", "real_time_factor"))
    assert about["expected"].startswith("0 to 1000") and not about["read_only"]
    assert "simulated over wall time" in about["about"]
    assert yaml.safe_load(shell("param", "describe", "plant", "duration"))["read_only"]
    assert "plant has no parameter 'nothing'" in shell.refused(
        "param", "describe", "plant", "nothing"
    )


def test_a_parameter_of_ros_itself_is_there_for_those_that_ask_for_it(shell):
    assert shell("param", "get", "plant", "use_sim_time") == "false\n"
    assert (
        shell("param", "set", "asr", "use_sim_time", "true") == "asr.use_sim_time: False -> True\n"
    )
    shell("param", "set", "asr", "use_sim_time", "false")
    assert "use_sim_time" not in shell("param", "list", "plant")


class AtHundredHertz:
    """A graph with 100 messages a second on each topic, and 50 ms to subscribe."""

    def __init__(self) -> None:
        self.now = 0.0

    def monotonic(self) -> float:
        return self.now

    def sleep(self, seconds: float) -> None:
        self.now += seconds

    def create_subscription(self, kind, *_, **__):
        self.now += 0.05
        begun, taken = self.now, 0

        def take(*_):
            nonlocal taken
            is_there = taken < int((self.now - begun) * 100.0)
            taken += is_there
            return taken if is_there else None

        return SimpleNamespace(handle=SimpleNamespace(take_message=take), msg_type=kind)

    def get_publishers_info_by_topic(self, _) -> list:
        return []


def test_rates_are_of_one_time_for_all_topics(monkeypatch):
    """They agree to one message at either end of the two seconds."""
    clock = AtHundredHertz()
    monkeypatch.setattr(live_graph, "time", clock)
    topics = dict.fromkeys(("a", "b", "c", "d"), "std_msgs/msg/Header")
    assert live_graph._rates(clock, topics, 2.0) == pytest.approx(
        dict.fromkeys(topics, 100.0), abs=1.0
    )


def test_what_cannot_be_done_is_one_line(shell):
    assert "real_time_factor: 'fast' is refused, expected double" in shell.refused(
        "param", "set", "plant", "real_time_factor", "fast"
    )
    assert "plant refuses: " in shell.refused("param", "set", "plant", "real_time_factor", "-1")
    assert "plant has no parameter 'nothing'" in shell.refused("param", "get", "plant", "nothing")
    assert "no node '/ev/unknown'; there are /ev/asr, " in shell.refused("param", "get", "unknown")
    assert "no master of time (plant) in /other: there is none" in shell.refused(
        "pause", "--namespace", "/other"
    )
    assert "no topic '/ev/nothing'; known: " in shell.refused("topic", "echo", "nothing")


class Discovery:
    """A node and a clock for which others come up at given times [s]."""

    def __init__(self, **others: float) -> None:
        self.now, self.others = 0.0, others

    def monotonic(self) -> float:
        return self.now

    def sleep(self, seconds: float) -> None:
        self.now += seconds

    def get_fully_qualified_name(self) -> str:
        return "/us"

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        return [
            ("us", "/"),
            ("_hidden", "/"),
            *((name, "/ev") for name, at in self.others.items() if at <= self.now),
        ]


@pytest.mark.parametrize(
    ("others", "found", "at"),
    [
        # as on an idle machine
        ({"plant": 0.1, "driver": 0.15}, ["/ev/driver", "/ev/plant"], 0.65),
        # by the middleware's own discovery
        ({"plant": 3.1, "driver": 3.4}, ["/ev/driver", "/ev/plant"], 3.9),
        ({}, [], 4.0),
    ],
)
def test_a_graph_is_looked_at_when_no_more_nodes_come(monkeypatch, others, found, at):
    """Half a second without another one; nothing is there when four seconds have brought none."""
    node = Discovery(**others)
    monkeypatch.setattr(present_graph, "time", node)
    assert present_graph._found(node) == bool(found)
    assert present_graph.full_names(node) == found
    assert node.now == pytest.approx(at, abs=0.05)  # it looks every 20 ms


def test_the_version_is_that_of_the_packages(capsys):
    perform(["--version"])
    assert capsys.readouterr().out == f"ev-stack {version('ev_stack')}\n"


def test_an_unknown_topic_lists_the_known_ones(domain):
    shown = inspect(domain, "--echo", "/ev/wheels")
    assert (shown.returncode, shown.stdout, shown.stderr.count("\n")) == (1, "", 1)
    assert "no topic '/ev/wheels'; known: " in shown.stderr and "/ev/wheel_states" in shown.stderr


def test_it_says_that_nothing_runs_and_where_something_does(domain):
    with free_domain() as empty:
        shown = inspect(empty, "--seconds", "0.1")
    assert (shown.returncode, shown.stdout, shown.stderr.count("\n")) == (1, "", 1)
    assert f"no nodes are running in ROS domain {empty}; runs are under way in: " in shown.stderr
    assert str(domain) in re.findall(r"\d+", shown.stderr.partition("way in: ")[2])


@pytest.mark.parametrize("seconds", ["0", "-1", "nan", "long"])
def test_a_time_that_is_none_is_refused(seconds):
    refused = inspect(0, "--seconds", seconds)
    assert refused.returncode == 2
    assert "--seconds" in refused.stderr.splitlines()[-1]
