"""Every node of a run as its own process: started, watched, stopped, and nothing left behind."""

from __future__ import annotations

import signal
import subprocess
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from ev_core.node_loop import ordinary_steps
from ev_core.nodes.stop_request import StopRequest
from ev_sim.recording.files_of_run import PARAMETERS
from ev_sim.recording.outcome import Outcome, Progress
from ev_sim.recording.progress_bar import announce
from ev_sim.running.domain import free_domain, own_namespace
from ev_sim.running.node_parameters import node_parameters, write_parameter_file
from ev_sim.running.node_process import NodeProcess, command, start_node
from ev_sim.running.observing import refuse_unready
from ev_sim.running.output_folder import forget_recording
from ev_sim.running.real_bus import real_bus
from ev_sim.running.told import Told, told
from ev_sim.running.watched_run import Beginning, WatchedRun
from ev_sim.scenarios.scenario import Run

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


def run_in_processes(
    run: Run, directory: Path, bag: bool, progress: Progress, own_nodes: Mapping[str, Sequence[str]] | None = None
) -> Outcome:
    """Drive a run to its end, every node as its own process over DDS; the recorder writes into `directory`.

    `own_nodes` are commands by role that are started in the place of our nodes, with the same ROS arguments.

    RunFailed, with a line that names the node, if one ends before the run does; KeyboardInterrupt if Ctrl-C or SIGTERM
    came. All nodes are stopped then.
    """
    refuse_unready()
    file = directory / PARAMETERS
    ordinary_steps.keep_code()  # whoever has updated the sources has set up nothing anew
    with (
        free_domain() as domain,
        own_namespace(domain, run.namespace),
        StopRequest(patient=True) as stop,
        real_bus(run, domain, directory) as bus,
    ):
        parameters = node_parameters(run, directory, bag, bus)
        write_parameter_file(file, run, parameters)
        while True:
            beginning = Beginning(patient=bool(own_nodes))
            with told(run.namespace) as words:
                announce(f"{run.name}: ROS_DOMAIN_ID={domain}, namespace {run.namespace}")
                with started_nodes(parameters, own_nodes or {}, run, file, domain, words) as nodes:
                    watched = WatchedRun(run, nodes, words)
                    has_begun = watched.drive(beginning, progress, stop)
                if has_begun:  # all have told their last words
                    return watched.outcome(directory)
            forget_recording(directory)
