"""What is seen to before the nodes of a run are started, each in a process of its own."""

import os
from pathlib import Path

import pytest

from ev_core.node_loop import steps
from ev_msgs_py.contract.roles import RECORDER, ROLES
from ev_sim.recording.outcome import RunFailed
from ev_sim.running import domain, processes
from ev_sim.running.node_process import command
from ev_sim.scenarios.scenario import load_scenario


@pytest.mark.parametrize("kept", [True, False])
def test_the_loop_of_the_nodes_is_compiled_if_nobody_has(kept, tmp_path, monkeypatch):
    """As after an update of the sources: nodes do not wait for it, and went without it at half the speed."""

    def fail():
        raise RunFailed("no domain")

    compiled = []
    monkeypatch.setattr(steps, "is_kept", lambda: kept)
    monkeypatch.setattr(steps, "address", lambda: compiled.append("the loop"))
    monkeypatch.setattr(domain, "free_domain", fail)
    run = load_scenario("coast_down").runs[0]
    with pytest.raises(RunFailed, match=r"^no domain$"):
        processes.run_in_processes(run, tmp_path, False, lambda _: None)
    assert compiled == ([] if kept else ["the loop"])


@pytest.mark.parametrize("name", [*ROLES, RECORDER])
def test_no_program_stands_between_the_runner_and_a_node(name):
    """`ros2 run` hands no death signal on: nodes outlived a runner that was killed."""
    (path,) = command(name)
    assert os.access(path, os.X_OK) and Path(path).name == name
