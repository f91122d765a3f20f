"""How the processes of the nodes of a run are started."""

import os
from pathlib import Path

import pytest

from ev_msgs_py.contract.roles import RECORDER, ROLES
from ev_sim.running.node_process import command


@pytest.mark.parametrize("name", [*ROLES, RECORDER])
def test_no_program_stands_between_the_runner_and_a_node(name):
    """`ros2 run` hands no death signal on: nodes outlived a runner that was killed."""
    (path,) = command(name)
    assert os.access(path, os.X_OK) and Path(path).name == name
