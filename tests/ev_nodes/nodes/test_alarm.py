"""Waits that do not go by the time of day, whatever the middleware does."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import time

import pytest
from campaign.time_of_day import TimeOfDay
from campaign.trial import Skipped
from helpers.patience import PATIENCE
from helpers.ros_graph import ros_domain
from rclpy.node import Node
from std_msgs.msg import Empty

from ev_nodes.stepping import time_of_day
from ev_nodes.stepping.spinning import spin
from ev_stack.running.domain import discovery_port, free_domain

HOUR = 3600 * 10**9  # ns


class Waiting(Node):
    """A node that would wait an hour for a message that never comes."""

    polling_place = 0
    looks = 0

    def poll(self) -> bool:
        self.looks += 1
        return False

    def take_steps(self, until: float, guard: int) -> bool:
        return False

    def sweep(self) -> None:
        pass

    def awaits(self) -> object:
        return self.subscription.handle

    def wake_up_within(self) -> float:
        return 3600.0

    def idle(self) -> None:
        pass


def test_a_wait_ends_when_the_time_of_day_is_set_back(monkeypatch):
    """The alarm ends it: else it takes an hour, or as long as this test may take."""
    ahead = [HOUR, HOUR, HOUR, 0]
    monkeypatch.setattr(time_of_day, "ahead", lambda: ahead.pop(0) if len(ahead) > 1 else ahead[0])
    with ros_domain() as context:
        node = Waiting("waiting", context=context)
        node.subscription = node.create_subscription(Empty, "nothing", lambda _: None, 1)
        spin([node], lambda: node.looks > 0)
        node.destroy_node()


def test_no_node_is_woken_up_while_the_clocks_agree(monkeypatch):
    """Clocks that are made to go faster, or are set forward, end no wait: that would cost time."""
    ahead = iter(range(0, 10 * HOUR, HOUR))
    seen, woken = [], []
    monkeypatch.setattr(time_of_day, "_AT_FIRST", 0)
    monkeypatch.setattr(
        time_of_day, "ahead", lambda: seen.append(next(ahead, 10 * HOUR)) or seen[-1]
    )
    with ros_domain() as context:
        node = Node("sleeper", context=context)
        with time_of_day.Alarm(node, lambda: woken.append(True)):
            while len(seen) < 12:
                time.sleep(0.001)
        node.destroy_node()
    assert not woken


@pytest.mark.parametrize(
    "ahead", [[HOUR, HOUR, 0], [0]], ids=["while it watches", "while the node was being made"]
)
def test_a_process_tells_the_graph_several_times_what_it_consists_of(ahead, monkeypatch):
    """It repeats itself after the time of day was set back, until older announcements are gone."""
    monkeypatch.setattr(time_of_day, "ahead", lambda: ahead.pop(0) if len(ahead) > 1 else ahead[0])
    monkeypatch.setattr(time_of_day, "_AT_FIRST", HOUR)
    monkeypatch.setattr(time_of_day, "_AGAIN", (0.0, 0.05, 0.1))
    announced = []
    with ros_domain() as context:
        node = Node("teller", context=context)
        create = node.create_publisher
        monkeypatch.setattr(
            node,
            "create_publisher",
            lambda *how, **more: announced.append(how[1]) or create(*how, **more),
        )
        given_up = time.monotonic() + PATIENCE
        with time_of_day.Alarm(node):
            while len(announced) < 3 and time.monotonic() < given_up:
                time.sleep(0.001)
        node.destroy_node()
    assert announced == ["/parameter_events"] * 3


ANNOUNCED = """
import sys, rclpy
from rclpy.node import Node
from ev_nodes.stepping.time_of_day import Alarm
rclpy.init()
with Alarm(Node("announced")):
    sys.stdin.read()
"""
ANOTHER = 5  # a participant that is not there
SILENCE = 0.5  # s; a node announces itself every 0.1 s, or more often


def test_a_node_goes_on_announcing_itself_when_the_time_of_day_is_set_back(tmp_path):
    """Its thread of timed events would wait for an hour.

    Where that happened to all, they did not find each other.
    """
    try:
        of_the_node = TimeOfDay(tmp_path)
    except Skipped as reason:
        pytest.skip(str(reason))
    with free_domain() as domain, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind(("127.0.0.1", discovery_port(domain, ANOTHER)))
        other.settimeout(PATIENCE)
        environment = {**os.environ, **of_the_node.environment, "ROS_DOMAIN_ID": str(domain)}
        with subprocess.Popen(
            [sys.executable, "-c", ANNOUNCED], env=environment, stdin=subprocess.PIPE
        ) as node:
            other.recv(65536)
            # the kernel's clock stays, so from here on waits last for an hour
            of_the_node.jump(HOUR // 10**9)
            other.settimeout(SILENCE)
            with pytest.raises(TimeoutError):
                while True:
                    other.recv(65536)
            of_the_node.jump(0)
            other.settimeout(PATIENCE)
            assert other.recv(65536).startswith(b"RTPS")
            assert node.poll() is None
            node.stdin.close()
