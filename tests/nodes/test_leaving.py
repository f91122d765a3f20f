"""Nodes of a runner leave the graph without a word; what says goodbye can lock up others that remove it."""

import os
import signal
import subprocess
import time
from collections.abc import Callable
from contextlib import suppress

import pytest
from rclpy.node import NodeNameNonExistentError
from ros_graph import NAMESPACE, PATIENCE, Probe, ros_domain

from ev_core.run_role import SILENTLY
from ev_sim.running.node_process import command

pytestmark = pytest.mark.slow

LEASE = 4.0  # s, of config/fastdds.xml


def start(domain: int, silently: bool, *told: str) -> subprocess.Popen:
    environment = {**os.environ, "ROS_DOMAIN_ID": str(domain), **({SILENTLY: "1"} if silently else {})}
    words = [*command("driver"), "--ros-args", "-r", f"__ns:={NAMESPACE}", *told]
    return subprocess.Popen(words, env=environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)


def seconds_until(holds: Callable[[], bool]) -> float:
    start = time.monotonic()
    while not holds():
        assert time.monotonic() < start + PATIENCE
        time.sleep(0.02)
    return time.monotonic() - start


@pytest.mark.parametrize("silently", [False, True])
def test_a_node_says_goodbye_unless_its_runner_leaves_too(silently):
    """Seconds that others still know of it: none, or what is left of its lease, which is announced every 0.1 s.

    What it hears is gone at once in any case: who waits until its last word has arrived does not wait for it. Its
    participant is never deleted, because that can last for ever: a hidden node shows it until the lease is over.
    """
    with ros_domain() as context:
        probe = Probe(context)

        def is_there() -> bool:
            return ("driver", NAMESPACE) in probe.get_node_names_and_namespaces()

        def listens() -> bool:
            with suppress(NodeNameNonExistentError):
                return bool(probe.get_subscriber_names_and_types_by_node("driver", NAMESPACE))
            return False

        node = start(context.get_domain_id(), silently)
        seconds_until(listens)
        node.send_signal(signal.SIGINT)
        assert node.wait(timeout=PATIENCE) == 0
        heard = seconds_until(lambda: not listens())
        kept = seconds_until(lambda: silently or ("_driver", "/") in probe.get_node_names_and_namespaces())
        stayed = heard + seconds_until(lambda: not is_there())
    assert heard < LEASE / 2 and kept < LEASE / 2
    assert (stayed > LEASE / 2) == silently


def test_who_leaves_without_a_word_still_says_what_was_wrong():
    node = start(0, True, "-p", "control_period:=-1.0")
    said, _ = node.communicate(timeout=PATIENCE)
    assert node.returncode == 1
    assert said.count("\n") == 1
    assert said.startswith("driver: parameter control_period")
