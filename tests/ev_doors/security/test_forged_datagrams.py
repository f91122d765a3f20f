"""Forged datagrams in the name of a node's publisher are noticed: the run names the readers."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from ev_stack.recording.recording import signal_hash
from ev_stack.running.domain import free_domain
from ev_stack.running.processes import run_in_process, run_in_processes
from ev_stack.scenarios.scenario import Overrides, load_scenario

TOOLS = Path(__file__).parents[3] / "tools"
FORGED = 3.0  # a finite number that no node of the run says


@pytest.mark.slow
@pytest.mark.parametrize(
    ("drive", "forged", "to", "topic"),
    [
        pytest.param(run_in_processes, "asr", "plant", "torque_command", marks=pytest.mark.weekly),
        (run_in_process, "asr", "plant", "torque_command"),
        pytest.param(
            run_in_processes, "driver", "recorder", "driver/command", marks=pytest.mark.weekly
        ),
    ],
)
def test_commands_in_the_name_of_another_node_make_a_run_not_reproducible(
    drive, forged, to, topic, tmp_path, monkeypatch
):
    """They come before the real ones with the same numbers of the stream.

    The middleware drops the real ones as repeated. In lockstep such a run would end with another
    hash, without a cause that anybody sees.
    """
    values = [("plant", "real_time_factor", 1.0)]
    run = load_scenario("shchur2019", Overrides(duration=2.5, values=values)).runs[0]
    with free_domain() as domain:
        monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
        words = [sys.executable, "-m", "campaign.forger", forged, str(FORGED), to]
        environment = {
            **os.environ,
            "PYTHONPATH": os.pathsep.join((str(TOOLS), os.environ.get("PYTHONPATH", ""))),
        }
        with subprocess.Popen(words, env=environment, stdout=subprocess.PIPE, text=True) as forger:
            assert forger.stdout.readline() == "here\n"
            outcome = drive(run, tmp_path, False, lambda _: None)
            forger.terminate()
            assert forger.stdout.read().startswith("forged ")
    named = [
        f"read on {topic} what {forged} did not write" in line for line in outcome.not_reproducible
    ]
    assert all(named)
    assert any(line.startswith(f"node {to}: ") for line in outcome.not_reproducible)
    assert len(signal_hash(outcome.recording)) == 64
