"""Waits that do not go by the time of day, whatever the middleware does."""

from __future__ import annotations

import os
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
    monkeypatch.setattr(
        time_of_day, "ahead", lambda: seen.append(next(ahead, 10 * HOUR)) or seen[-1]
    )
    with ros_domain() as context, time_of_day.Alarm(context, lambda: woken.append(True)):
        while len(seen) < 12:
            time.sleep(0.001)
    assert not woken


@pytest.mark.weekly
@pytest.mark.slow
def test_a_car_in_real_time_goes_on_when_the_time_of_day_is_set_back(tmp_path):
    """The middleware of the wheels waits by the time of day: without the alarm the plant stands for an hour.

    The time of day is an hour ahead for a moment, in which a wait of the plant begins.
    """
    try:
        clock = TimeOfDay(tmp_path)
    except Skipped as reason:
        pytest.skip(str(reason))
    text = (
        "import sys\n"
        "from pathlib import Path\n"
        "from helpers.ros_graph import shchur\n"
        "from ev_stack.running.processes import run_in_processes\n"
        "run = shchur(3.0, **{'*__mode': 'realtime'})\n"
        "progress = lambda time: print(f'{time:.2f}', flush=True)\n"
        "run_in_processes(run, Path(sys.argv[1]), False, progress)\n"
    )
    environment = {**os.environ, **clock.environment, "PYTHONPATH": os.pathsep.join(sys.path)}
    (tmp_path / "out").mkdir()
    words = [sys.executable, "-c", text, str(tmp_path / "out")]
    with subprocess.Popen(words, env=environment, stdout=subprocess.PIPE, text=True) as run:
        try:
            for line in run.stdout:
                if float(line) > 1.0:
                    break
            for _ in range(5):
                clock.jump(HOUR // 10**9)
                time.sleep(0.05)
                clock.jump(0)
                time.sleep(0.1)
            rest = run.communicate(timeout=PATIENCE / 3)[0]
        finally:
            run.kill()
    assert float(rest.split()[-1]) == 3.0
