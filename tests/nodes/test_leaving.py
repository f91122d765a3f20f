"""Nodes of a runner leave the graph without a word; what says goodbye can lock up others that remove it."""

import os
import signal
import subprocess
import time

import pytest
from ros_graph import NAMESPACE, PATIENCE, Probe, ros_domain

from ev_msgs_py.nodes.leaving import SILENTLY
from ev_sim.running.node_command import command

pytestmark = pytest.mark.slow

LEASE = 4.0  # s, of config/fastdds.xml


def start(domain: int, silently: bool, *told: str) -> subprocess.Popen:
    environment = {**os.environ, "ROS_DOMAIN_ID": str(domain), **({SILENTLY: "1"} if silently else {})}
    words = [*command("driver"), "--ros-args", "-r", f"__ns:={NAMESPACE}", *told]
    return subprocess.Popen(words, env=environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)


@pytest.mark.parametrize("silently", [False, True])
def test_a_node_says_goodbye_unless_its_runner_leaves_too(silently):
    """Seconds that the graph still has the node: none, or what is left of its lease, announced every 0.1 s."""
    with ros_domain() as context:
        probe = Probe(context)

        def is_there() -> bool:
            return ("driver", NAMESPACE) in probe.get_node_names_and_namespaces()

        node = start(context.get_domain_id(), silently)
        deadline = time.monotonic() + PATIENCE
        while not is_there():
            assert time.monotonic() < deadline
            time.sleep(0.02)
        node.send_signal(signal.SIGINT)
        assert node.wait(timeout=PATIENCE) == 0
        ended = time.monotonic()
        while is_there():
            assert time.monotonic() < ended + PATIENCE
            time.sleep(0.02)
        stayed = time.monotonic() - ended
    assert (stayed > LEASE / 2) == silently


def test_who_leaves_without_a_word_still_says_what_was_wrong():
    node = start(0, True, "-p", "control_period:=-1.0")
    said, _ = node.communicate(timeout=PATIENCE)
    assert node.returncode == 1
    assert said.count("\n") == 1
    assert said.startswith("driver: parameter control_period")
