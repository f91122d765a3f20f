"""A run over DDS: all nodes in this process, or each as its own, watched up to the end of plant and recorder."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import rclpy
from rclpy.parameter import Parameter

from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.roles import MASTER, RECORDER
from ev_nodes.run_role import OF_ROS, node_maker, one_line, security_is_asked_for
from ev_nodes.stepping.runner_line import RUNNER_LINE
from ev_nodes.stepping.spinning import spin
from ev_nodes.stepping.stepped_node import SteppedNode
from ev_stack.recorder_node import RecorderNode
from ev_stack.recording.outcome import Outcome, Progress, RunFailed, announce
from ev_stack.recording.recording import SIGNALS, load
from ev_stack.running.domain import own_place
from ev_stack.running.node_process import started_nodes
from ev_stack.running.node_reports import NodeReports, node_reports, observing, refuse_unready
from ev_stack.running.watching import RunWatcher
from ev_stack.scenarios.records import Run

_LOOK_PERIOD = 0.05  # s of wall time between looks at the processes
_OBSERVER = "run_scenario"  # the name of what is in the graph beside the nodes
_GLANCE_PERIOD = 0.1  # s of wall time between looks at simulated time


def run_in_processes(
    run: Run,
    directory: Path,
    bag: bool,
    progress: Progress,
    own_nodes: Mapping[str, Sequence[str]] | None = None,
) -> Outcome:
    """Drive a run to its end, every node as its own process over DDS.

    The recorder writes into `directory`.

    `own_nodes` are commands by role that are started in the place of our nodes, with the same ROS
    arguments.

    RunFailed, with a line that names the node, if one ends before the run does; KeyboardInterrupt
    if Ctrl-C or SIGTERM came. All nodes are stopped then.
    """
    refuse_unready()
    with (
        own_place(run, directory, bag) as place,
        node_reports(run.namespace, run.realtime) as reports,
    ):
        with started_nodes(place, own_nodes or {}, reports) as nodes:
            watcher = RunWatcher(run, nodes, reports, patient=bool(own_nodes))
            while not watcher.is_over:
                if place.stop.received:
                    raise KeyboardInterrupt
                time.sleep(_LOOK_PERIOD)
                lines = watcher.look()
                progress(reports.time)
                for line in lines:
                    announce(line)
                # Behind the look: the last report of a node comes before its end.
                watcher.notice_ends()
            progress(run.duration)
        reports.look()  # all nodes have sent their last reports
    recording = load(directory / SIGNALS)
    # In real time nothing waits for a recorder that was stopped; one that was stopped together with
    # the plant before the first step has no instant at all.
    reached = recording.time[-1] if len(recording.time) else 0.0
    if reached < watcher.last - 0.5 * stamps.to_seconds(run.period):
        raise RunFailed(f"node {RECORDER} was stopped, at {reached:g} s of simulated time")
    return reports.outcome(recording, watcher.wall_time)


def run_in_process(run: Run, directory: Path, bag: bool, progress: Progress) -> Outcome:
    """Drive a run to its end; everything that the recorder writes is in `directory` then.

    KeyboardInterrupt, when all nodes have finished what they did, if Ctrl-C or SIGTERM came before
    the end.
    """
    if security_is_asked_for(os.environ):
        raise RunFailed(
            "--in-process: DDS security gives keys to processes, not to nodes; drive one process"
            " per node"
        )
    nodes: list[SteppedNode] = []
    with (
        own_place(run, directory, bag) as place,
        observing(run.namespace, place.domain, _OBSERVER) as observer,
        node_reports(run.namespace, run.realtime) as reports,
    ):
        try:
            for name, values in place.parameters.items():
                # One environment serves all nodes of the process, so each finds its own line while
                # it is made.
                with _line(reports, name):
                    nodes.append(_node(name, run.namespace, values, observer.context))
            # Only these two end by themselves; all others wait for the next step.
            ending = [node for node in nodes if node.get_name() in (MASTER, RECORDER)]
            next_look = 0.0

            def finished() -> bool:
                nonlocal next_look
                if time.monotonic() >= next_look:
                    reports.look()
                    progress(reports.time)
                    next_look = time.monotonic() + _GLANCE_PERIOD
                return all(node.done for node in ending) or place.stop.received

            start = time.monotonic()
            spin(nodes, finished)
            wall_time = time.monotonic() - start
            if not all(node.done for node in ending):
                raise KeyboardInterrupt
            progress(run.duration)
        except OF_ROS as error:  # what ends a node that is a process of its own
            raise RunFailed(one_line(error)) from None
        finally:
            for node in nodes:
                node.close()
                node.destroy_node()
            reports.look()
    return reports.outcome(load(directory / SIGNALS), wall_time)


@contextmanager
def _line(reports: NodeReports, node: str) -> Iterator[None]:
    """Put the line of a node into the environment for the block, as a process would find it."""
    os.environ[RUNNER_LINE], _ = reports.line(node)
    try:
        yield
    finally:
        del os.environ[RUNNER_LINE]
        reports.started(node)


def parameter_overrides(values: Mapping[str, Any]) -> list[Parameter]:
    """Dotted names and values as a node takes them."""
    return [Parameter(name, value=value) for name, value in values.items()]


def _node(name: str, namespace: str, values: dict, context: rclpy.Context) -> object:
    arguments = {
        "context": context,
        "namespace": namespace,
        "parameter_overrides": parameter_overrides(values),
    }
    return RecorderNode(**arguments) if name == RECORDER else node_maker(name)(**arguments)
