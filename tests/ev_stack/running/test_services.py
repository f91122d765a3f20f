"""Actions on the live page, with every node a process: the numbers are those of a fresh run."""

from __future__ import annotations

import json
import subprocess
import time
from pathlib import Path
from typing import Any

import pytest
from helpers.patience import PATIENCE
from helpers.ros_graph import SERVICES, ros_domain
from helpers.run_script import ENVIRONMENT, RUN
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from std_srvs.srv import Trigger

pytestmark = pytest.mark.slow

SHORT = ("double_lane_change", "--duration", "0.5", "--no-report")


def signal_hash(folder: Path) -> str:
    return json.loads((folder / "summary.json").read_text())["signal_hash"]


@pytest.mark.weekly
def test_pause_reset_set_reset_resume_gives_a_fresh_run(tmp_path: Path):
    """A second reset at time zero counts as well: the other nodes answer to the changed car."""
    slowly = ["--set", "plant.real_time_factor=0.01"]  # 50 s, unless the test sets another pace
    with ros_domain() as context:
        domain = str(context.get_domain_id())
        words = [RUN, *SHORT, *slowly, "--out", tmp_path / "live"]
        run = subprocess.Popen(
            words, env={**ENVIRONMENT, "ROS_DOMAIN_ID": domain}, stdout=subprocess.DEVNULL
        )
        node = Node("operator", context=context)
        executor = SingleThreadedExecutor(context=context)
        executor.add_node(node)
        callers = {name: node.create_client(Trigger, f"/ev/plant/{name}") for name in SERVICES}
        parameters = AsyncParameterClient(node, "/ev/plant")

        def wait(until: Any) -> None:
            deadline = time.monotonic() + PATIENCE
            while not until():
                assert time.monotonic() < deadline and run.poll() is None
                executor.spin_once(timeout_sec=0.05)

        def answer(future: Any) -> Any:
            wait(future.done)
            return future.result()

        def given(name: str, value: float) -> bool:
            return answer(
                parameters.set_parameters_atomically([Parameter(name, value=value)])
            ).result.successful

        wait(
            lambda: (
                parameters.services_are_ready()
                and all(each.service_is_ready() for each in callers.values())
            )
        )
        for word in (
            "pause",
            "reset",
            ("initial_speed", 15.0),
            "reset",
            ("real_time_factor", 0.0),
            "resume",
        ):
            if isinstance(word, tuple):
                assert given(*word)
            else:
                assert answer(callers[word].call_async(Trigger.Request())).success
        assert run.wait(PATIENCE) == 0
    fresh = [
        RUN,
        *SHORT,
        "--offline",
        "--set",
        "plant.initial_speed=15.0",
        "--out",
        tmp_path / "fresh",
    ]
    subprocess.run(fresh, env=ENVIRONMENT, check=True, capture_output=True)
    assert signal_hash(tmp_path / "live") == signal_hash(tmp_path / "fresh")
