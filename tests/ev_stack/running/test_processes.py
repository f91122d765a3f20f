"""Start of the nodes of a run, and the waits at its end."""

import os
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from helpers.ros_graph import shchur

from ev_msgs_py.contract.roles import RECORDER, ROLES
from ev_stack import recorder_node as recorder
from ev_stack.recording.outcome import RunFailed
from ev_stack.recording.recording import SIGNALS, Recording, save
from ev_stack.running import processes
from ev_stack.running.node_process import command
from ev_stack.running.processes import run_in_process, run_in_processes


@pytest.mark.parametrize("name", [*ROLES, RECORDER])
def test_no_program_stands_between_the_runner_and_a_node(name):
    """`ros2 run` hands no death signal on: nodes outlived a runner that was killed."""
    (path,) = command(name)
    assert os.access(path, os.X_OK) and Path(path).name == name


@pytest.mark.slow
def test_one_process_stays_until_the_plant_has_ended_too(monkeypatch, tmp_path: Path):
    """The plant ends a period, 10 ms, behind its last state; a quick recorder has that by then."""
    monkeypatch.setattr(recorder, "POLL_PERIOD", 0.001)
    outcome = run_in_process(shchur(0.2, **{"*__mode": "realtime"}), tmp_path, True, lambda _: None)
    assert outcome.timing["steps"] == 20


def test_plant_and_recorder_that_end_before_the_first_step_are_one_line(
    monkeypatch, tmp_path: Path
):
    """Both end with status 0 when they are stopped, and leave a recording without an instant."""

    @contextmanager
    def ended(*_: object):
        save(Recording(np.empty(0), {}), tmp_path / SIGNALS)
        yield []

    monkeypatch.setattr(processes, "started_nodes", ended)
    with pytest.raises(RunFailed, match=r"^node recorder was stopped, at 0 s of simulated time$"):
        run_in_processes(shchur(0.2), tmp_path, False, lambda _: None)
