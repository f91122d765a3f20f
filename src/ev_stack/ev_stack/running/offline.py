"""Runs of scenarios without ROS, and the parameters of their nodes, as ROS takes them."""

from __future__ import annotations

import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from ev_core.lockstep.configuration import Configuration
from ev_msgs_py.contract.roles import MASTER, RECORDED, RECORDER
from ev_msgs_py.contract.topics import Topic
from ev_msgs_py.refusal import ParameterError
from ev_stack.recording.offline import graph_run, written_topics
from ev_stack.recording.outcome import Outcome, Progress
from ev_stack.recording.recording import (
    BAG,
    PARAMETERS,
    SIGNALS,
    atomic_file,
    recording_of_series,
    save,
)
from ev_stack.scenarios.records import Run


def recorded_topics(run: Run) -> list[Topic]:
    """The topics of a run that its recorder takes."""
    return [topic for topic in written_topics(run.configurations) if topic.signal in RECORDED]


def node_parameters(
    run: Run, directory: Path, bag: bool, besides: Mapping[str, Mapping[str, Any]] | None = None
) -> dict[str, dict[str, Any]]:
    """Dotted names and values for every role and the recorder.

    `directory` is where the recorder writes.

    The parameters of roles in `besides` go before their own. ParameterError for an empty list that
    no node would receive.
    """
    nodes: dict[str, dict[str, Any]] = {}
    for role, configuration in run.configurations.items():
        further = (besides or {}).get(role, {})
        nodes[role] = {**_of_a_node(role, configuration), **further}
    # Without it time would begin before the recorder is connected, and run ahead of it.
    nodes[MASTER]["await_recorder"] = True
    common = run.configurations[MASTER].common
    nodes[RECORDER] = {
        "directory": str(directory),
        "topics": [topic.name for topic in recorded_topics(run)],
        "bag": bag,
        "parameter_file": str(directory / PARAMETERS) if bag else "",
        "control_period": common.control_period,
        "mode": common.mode,
        "duration": run.duration,
    }
    return nodes


def _of_a_node(role: str, configuration: Configuration) -> dict[str, Any]:
    """Names and values of a node's parameters as a ROS parameter file can have them."""
    found: dict[str, Any] = {}
    declared = configuration.declared()
    for name, value in configuration.values().items():
        if value != ():
            found[name] = list(value) if isinstance(value, tuple) else value
        # ROS has no type for an empty list, so what is left out has to be empty by itself.
        elif declared[name] != ():
            raise ParameterError(
                f"{role}: parameter {name}: [] is refused, expected one element at least: "
                "nodes cannot be given an empty list (--offline can)",
                name,
            )
    return found


def write_parameter_file(path: Path, run: Run, nodes: dict[str, dict[str, Any]]) -> None:
    """One ROS parameter file with all parameters of the nodes of a run."""
    content = {
        f"{run.namespace}/{node}": {"ros__parameters": values} for node, values in nodes.items()
    }
    with atomic_file(path) as file:
        file.write(yaml.safe_dump(content, sort_keys=False).encode())


def drive_offline(run: Run, progress: Progress = lambda time: None) -> Outcome:
    """Drive one run of a scenario.

    Raises what `run_offline` does. To compile does not count as driving.
    """
    graph = graph_run(run.configurations, run.duration)
    start = time.monotonic()
    notes: list[str] = []

    def note(role: str, text: str) -> None:
        notes.append(f"{run.namespace}/{role}: {text}")

    graph.drive(progress, note)
    recording = recording_of_series(graph.series, written_topics(run.configurations))
    return Outcome(recording, time.monotonic() - start, notes=tuple(notes))


def run_offline_into(run: Run, directory: Path, bag: bool, progress: Progress) -> Outcome:
    """Drive one run and leave in `directory` what its nodes would: parameters, signals, and a bag if it is wanted."""
    nodes = node_parameters(run, directory, bag)
    write_parameter_file(directory / PARAMETERS, run, nodes)
    outcome = drive_offline(run, progress)
    save(outcome.recording, directory / SIGNALS)
    if bag:
        from ev_stack.recording.run_recorder import write_bag  # a run without a bag needs no ROS
        from ev_stack.views.messages import views_of_nodes

        topics = recorded_topics(run)
        names = [f"{run.namespace}/{topic.name}" for topic in topics]
        views = views_of_nodes(run.namespace, nodes)
        write_bag(outcome.recording, topics, names, run.period, directory / BAG, views)
    return outcome
