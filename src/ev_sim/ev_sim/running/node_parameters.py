"""The parameters of every node of a run, as ROS takes them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from ev_msgs_py.contract.roles import MASTER, RECORDED, RECORDER
from ev_msgs_py.contract.topics import TOPICS, Topic
from ev_sim.recording.files_of_run import atomic_file
from ev_sim.scenarios.scenario import Run


def recorded_topics(run: Run) -> list[Topic]:
    """The topics that the methods of a run write, in the order of the topic table."""
    written = {signal for configuration in run.configurations.values() for signal in configuration.method.writes}
    return [topic for signal, topic in TOPICS.items() if signal in RECORDED and signal in written]


def node_parameters(
    run: Run, directory: Path, bag: bool, besides: Mapping[str, Mapping[str, Any]] | None = None
) -> dict[str, dict[str, Any]]:
    """Dotted names and values for every role and the recorder; `directory` is where the recorder writes.

    The parameters of roles in `besides` go before their own.
    """
    nodes = {
        role: {name: _plain(value) for name, value in configuration.values().items() if value != ()}
        | dict((besides or {}).get(role, {}))
        for role, configuration in run.configurations.items()
    }
    nodes[MASTER]["await_recorder"] = True
    common = run.configurations[MASTER].common
    nodes[RECORDER] = {
        "directory": str(directory),
        "topics": [topic.name for topic in recorded_topics(run)],
        "bag": bag,
        "control_period": common.control_period,
        "mode": common.mode,
        "duration": run.duration,
    }
    return nodes


def _plain(value: Any) -> Any:
    return list(value) if isinstance(value, tuple) else value


def write_parameter_file(path: Path, run: Run, nodes: dict[str, dict[str, Any]]) -> None:
    """One ROS parameter file with all parameters of the nodes of a run."""
    content = {f"{run.namespace}/{node}": {"ros__parameters": values} for node, values in nodes.items()}
    with atomic_file(path) as file:
        file.write(yaml.safe_dump(content, sort_keys=False).encode())
