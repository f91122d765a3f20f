"""scripts/inspect.sh shows a graph without the ros2 command, and says so when there is none."""

import os
import re
import signal
import subprocess
from collections.abc import Iterator

import pytest
from ros_graph import NAMESPACE, NODES
from run_script import ENVIRONMENT, ROOT, Running

from ev_msgs_py.contract.roles import RECORDED
from ev_msgs_py.contract.topics import TOPICS
from ev_sim.running.domain import free_domain

pytestmark = pytest.mark.slow


def inspect(domain: int, *words: str) -> subprocess.CompletedProcess:
    environment = {**ENVIRONMENT, "ROS_DOMAIN_ID": str(domain)}
    command = [ROOT / "scripts" / "inspect.sh", *words]
    return subprocess.run(command, env=environment, capture_output=True, text=True, timeout=60)


@pytest.fixture(scope="module")
def domain(tmp_path_factory) -> Iterator[int]:
    """The domain of a graph that is held at real time."""
    running = Running(tmp_path_factory.mktemp("inspect") / "out", "--set", "plant.real_time_factor=1")
    yield int(re.search(r"ROS_DOMAIN_ID=(\d+), namespace /ev\n", running.text())[1])
    os.killpg(running.script.pid, signal.SIGINT)
    running.end(within=10.0)


def test_it_shows_nodes_topics_ends_and_rates(domain):
    shown = inspect(domain, "--seconds", "0.5").stdout
    nodes, _, topics = shown.partition("\n\n")
    assert {line.strip() for line in nodes.splitlines()[1:]} >= {f"{NAMESPACE}/{name}" for name in NODES}
    written = set(re.findall(rf"^  {NAMESPACE}/(\S+)  ", topics, re.MULTILINE))
    assert written <= {topic.name for topic in TOPICS.values()}
    for name in ("wheel_states", "driver/command", "torque_request", "torque_command", "steering_column/state"):
        kind, rate = re.search(rf"^  {NAMESPACE}/{name}  (\S+)  ([\d.]+) Hz$", topics, re.MULTILINE).groups()
        assert kind == next(topic.message_type for topic in TOPICS.values() if topic.name == name)
        assert float(rate) > 0.0
    assert re.search(r"/ev/torque_request .*\n    electronic_differential -> asr, recorder\n", topics)
    assert "inspect_graph" not in shown


def test_topics_that_this_car_does_not_have_are_not_shown(domain):
    """The kinematic plant knows no tyre forces."""
    shown = inspect(domain, "--seconds", "0.1").stdout
    assert "tire_forces" in {TOPICS[signal].name for signal in RECORDED}
    assert "tire_forces" not in shown


def test_it_echoes_a_message(domain):
    shown = inspect(domain, "--echo", "/ev/driver/command")
    assert shown.returncode == 0
    assert "drive" in shown.stdout and "steering_wheel" in shown.stdout


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
