"""All nodes of a run in this process, talking over DDS as they always do."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import rclpy
from rclpy.parameter import Parameter

from ev_core.nodes.runner_line import RUNNER_LINE
from ev_core.nodes.spinning import spin
from ev_core.nodes.stepped_node import SteppedNode
from ev_core.run_role import OF_ROS, node_maker, one_line, security_is_asked_for
from ev_msgs_py.contract.roles import RECORDER
from ev_sim.nodes.recorder import RecorderNode
from ev_sim.recording.outcome import Outcome, Progress, RunFailed
from ev_sim.recording.recording import SIGNALS, load
from ev_sim.running.domain import own_place
from ev_sim.running.node_reports import NodeReports, node_reports, observing
from ev_sim.scenarios.scenario import Run

_OBSERVER = "run_scenario"  # the name of what is in the graph beside the nodes
_LOOK_PERIOD = 0.1  # s of wall time between looks at simulated time


def run_in_process(run: Run, directory: Path, bag: bool, progress: Progress) -> Outcome:
    """Drive a run to its end; everything that the recorder writes is in `directory` then.

    KeyboardInterrupt, when all nodes have finished what they did, if Ctrl-C or SIGTERM came before the end.
    """
    if security_is_asked_for(os.environ):
        raise RunFailed("--in-process: DDS security gives keys to processes, not to nodes; drive one process per node")
    nodes: list[SteppedNode] = []
    with (
        own_place(run, directory, bag) as place,
        observing(run.namespace, place.domain, _OBSERVER) as observer,
        node_reports(run.namespace, run.realtime) as reports,
    ):
        try:
            for name, values in place.parameters.items():
                with _line(reports, name, not run.realtime):
                    nodes.append(_node(name, run.namespace, values, observer.context))
            recorder = nodes[-1]
            next_look = 0.0

            def finished() -> bool:
                nonlocal next_look
                if time.monotonic() >= next_look:
                    reports.look()
                    progress(reports.time)
                    next_look = time.monotonic() + _LOOK_PERIOD
                return recorder.done or place.stop.received

            start = time.monotonic()
            spin(nodes, finished)
            wall_time = time.monotonic() - start
            if not recorder.done:
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
def _line(reports: NodeReports, node: str, adds_up: bool) -> Iterator[None]:
    """What is made in the block finds the line of a node in the environment, as a process would."""
    os.environ[RUNNER_LINE], _ = reports.line(node, adds_up)
    try:
        yield
    finally:
        del os.environ[RUNNER_LINE]
        reports.started(node)


def parameter_overrides(values: Mapping[str, Any]) -> list[Parameter]:
    """Dotted names and values as a node takes them."""
    return [Parameter(name, value=value) for name, value in values.items()]


def _node(name: str, namespace: str, values: dict, context: rclpy.Context) -> object:
    arguments = {"context": context, "namespace": namespace, "parameter_overrides": parameter_overrides(values)}
    return RecorderNode(**arguments) if name == RECORDER else node_maker(name)(**arguments)
