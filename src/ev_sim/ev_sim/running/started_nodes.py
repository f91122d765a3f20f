"""The nodes of a run as processes: started together, and stopped with all that they have started."""

from __future__ import annotations

import signal
import subprocess
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from ev_sim.running.node_command import command
from ev_sim.running.node_process import NodeProcess, start_node
from ev_sim.running.scenarios.scenario import Run
from ev_sim.running.told import Told

# s for processes to stop when they are asked to: all of them have last words if the run has come to its end.
_PATIENCE, _AT_THE_END = 2.0, 10.0


@contextmanager
def started_nodes(
    names: Iterable[str], own: Mapping[str, Sequence[str]], run: Run, parameters: Path, domain: int, told: Told
) -> Iterator[list[NodeProcess]]:
    """The processes of nodes by name, with commands of others for some of them; RunFailed if one cannot be started."""
    nodes: list[NodeProcess] = []
    try:
        for name in names:
            words = own.get(name)
            nodes.append(start_node(name, words or command(name), not words, run, parameters, domain, told))
        yield nodes
    except BaseException:
        _stop(nodes, _PATIENCE)
        raise
    _stop(nodes, _AT_THE_END)


def _stop(nodes: list[NodeProcess], patience: float) -> None:
    """Ask all processes to stop, then make them, with whatever they have started."""
    for node in nodes:
        if node.process.poll() is None:
            node.send(signal.SIGINT)
    deadline = time.monotonic() + patience
    for node in nodes:
        with suppress(subprocess.TimeoutExpired):
            node.process.wait(max(deadline - time.monotonic(), 0.0))
    for node in nodes:
        node.end()
