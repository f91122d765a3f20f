"""Waits that do not go by the time of day, whatever the middleware does."""

from __future__ import annotations

import time

from rclpy.node import Node
from ros_graph import ros_domain
from std_msgs.msg import Empty

from ev_msgs_py.nodes import alarm
from ev_msgs_py.nodes.spinning import spin

HOUR = 3600 * 10**9  # ns


class Executor:
    """Notes whether it was woken up."""

    was_woken = False

    def wake(self) -> None:
        self.was_woken = True


class Waiting(Node):
    """A node that would wait for a message for an hour; nobody sends one."""

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
    """Without the alarm it takes an hour, or as long as this test may take."""
    ahead = [HOUR, HOUR, HOUR, 0]
    monkeypatch.setattr(alarm, "_ahead", lambda: ahead.pop(0) if len(ahead) > 1 else ahead[0])
    with ros_domain() as context:
        node = Waiting("waiting", context=context)
        node.subscription = node.create_subscription(Empty, "nothing", lambda _: None, 1)
        spin([node], lambda: node.looks > 0)
        node.destroy_node()


def test_nobody_is_woken_up_while_the_clocks_agree(monkeypatch):
    """Clocks that are made to go faster, or are set forward, end no wait: that would cost time."""
    ahead = iter(range(0, 10 * HOUR, HOUR))
    seen = []
    monkeypatch.setattr(alarm, "_ahead", lambda: seen.append(next(ahead, 10 * HOUR)) or seen[-1])
    with ros_domain() as context:
        executor = Executor()
        with alarm.Alarm(context, executor):
            while len(seen) < 12:
                time.sleep(0.001)
    assert not executor.was_woken
