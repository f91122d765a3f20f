"""Nodes of a runner leave the graph without a word.

What says goodbye can lock up others that remove it.
"""

import os
import signal
import subprocess
import time
from collections.abc import Callable
from contextlib import suppress

import pytest
from helpers.patience import PATIENCE, wait_until
from helpers.ros_graph import NAMESPACE, Probe, ros_domain
from rclpy.node import NodeNameNonExistentError

from ev_nodes.run_role import SILENTLY
from ev_stack.running.node_process import command

pytestmark = pytest.mark.slow

LEASE = 4.0  # s, of config/fastdds.xml


def start(domain: int, silently: bool, *arguments: str) -> subprocess.Popen:
    environment = {
        **os.environ,
        "ROS_DOMAIN_ID": str(domain),
        **({SILENTLY: "1"} if silently else {}),
    }
    words = [*command("driver"), "--ros-args", "-r", f"__ns:={NAMESPACE}", *arguments]
    return subprocess.Popen(
        words, env=environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
    )


def seconds_until(holds: Callable[[], bool]) -> float:
    start = time.monotonic()
    wait_until(holds)
    return time.monotonic() - start


def seconds_behind_the_end(silently: bool) -> tuple[float, float, float]:
    """Seconds for which others still see subscriptions, hidden node and name of an ended node."""
    with ros_domain() as context:
        probe = Probe(context)

        def is_there() -> bool:
            return ("driver", NAMESPACE) in probe.get_node_names_and_namespaces()

        def listens() -> bool:
            with suppress(NodeNameNonExistentError):
                return bool(probe.get_subscriber_names_and_types_by_node("driver", NAMESPACE))
            return False

        node = start(context.get_domain_id(), silently)
        wait_until(listens)
        node.send_signal(signal.SIGINT)
        assert node.wait(PATIENCE) == 0
        listened = seconds_until(lambda: not listens())
        hidden = seconds_until(
            lambda: silently or ("_driver", "/") in probe.get_node_names_and_namespaces()
        )
        return listened, hidden, listened + seconds_until(lambda: not is_there())


@pytest.mark.parametrize("silently", [False, True])
def test_a_node_says_goodbye_unless_its_runner_leaves_too(silently):
    """A node is gone at once with a goodbye, and without one when its lease is over.

    The lease is announced every 0.1 s. Its subscriptions are gone at once in any case: a node that
    waits until its last message has arrived does not wait for it. Its participant is never deleted,
    because that can last for ever: a hidden node shows it until the lease is over. On a busy
    machine a goodbye may arrive late, so one of several is to arrive within half a lease.
    """
    for _ in range(5):
        listened, hidden, stayed = seconds_behind_the_end(silently)
        assert not silently or stayed > LEASE / 2
        if max(listened, hidden, 0.0 if silently else stayed) < LEASE / 2:
            return
    pytest.fail(f"known for {listened:g}, {hidden:g} and {stayed:g} s")


def test_a_node_that_leaves_silently_still_prints_what_was_wrong():
    node = start(0, True, "-p", "control_period:=-1.0")
    output, _ = node.communicate(timeout=PATIENCE)
    assert node.returncode == 1
    assert output.count("\n") == 1
    assert output.startswith("driver: parameter control_period")
