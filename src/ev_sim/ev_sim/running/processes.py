"""Every node of a run as its own process: started, watched, stopped, and nothing left behind."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from ev_msgs_py.compiling import node_loop
from ev_msgs_py.nodes.stop_request import StopRequest
from ev_sim.running.beginning import Beginning
from ev_sim.running.domain import free_domain, own_namespace
from ev_sim.running.files_of_run import PARAMETERS
from ev_sim.running.node_parameters import node_parameters, write_parameter_file
from ev_sim.running.observing import refuse_unready
from ev_sim.running.outcome import Outcome, Progress
from ev_sim.running.output_folder import forget_recording
from ev_sim.running.progress_bar import announce
from ev_sim.running.real_bus import real_bus
from ev_sim.running.scenarios.scenario import Run
from ev_sim.running.started_nodes import started_nodes
from ev_sim.running.told import told
from ev_sim.running.watched_run import WatchedRun


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
    node_loop.keep()  # whoever has updated the sources has set up nothing anew
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
