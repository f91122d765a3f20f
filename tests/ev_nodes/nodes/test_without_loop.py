"""The room of the compiled loop may be left out: it makes steps faster, and changes no number."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from helpers.ros_graph import graph, offline_hash, recorded_hash, shchur

ROOM = "ev_nodes.node_loop"


def test_nodes_are_imported_without_the_room():
    """A module that is None in sys.modules is not found."""
    words = f"import sys; sys.modules[{ROOM!r}] = None; import ev_nodes.run_role, ev_stack.running.processes"
    subprocess.run([sys.executable, "-c", words], check=True)


@pytest.mark.slow
def test_without_the_room_nodes_take_all_steps_in_python(tmp_path: Path, monkeypatch):
    monkeypatch.setitem(sys.modules, ROOM, None)
    run = shchur(0.3)
    with graph(run, tmp_path) as nodes:
        nodes.run()
        assert all(
            node._ordinary is None for name, node in nodes.nodes.items() if name != "recorder"
        )
    assert recorded_hash(tmp_path) == offline_hash(run)
