"""What the recorder node is told."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.contract.roles import RECORDED
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.nodes.master_parameters import LONGEST
from ev_msgs_py.parameters.declaration import parameter

_ALL_TOPICS = tuple(TOPICS[signal].name for signal in RECORDED)


@dataclass(frozen=True, slots=True)
class RecorderParameters:
    """What is recorded and where it goes."""

    directory: str = parameter("recording", about="folder for bag/ and signals.npz, made if need be", read_only=True)
    topics: tuple[str, ...] = parameter(
        _ALL_TOPICS, choices=_ALL_TOPICS, about="topics that belong to every step of this run", read_only=True
    )
    bag: bool = parameter(True, about="write a bag besides signals.npz", read_only=True)
    control_period: float = parameter(
        0.01, unit="s", low=1e-4, high=1.0, about="step of the graph, the same for all nodes", read_only=True
    )
    mode: str = parameter(
        "lockstep",
        choices=("lockstep", "realtime"),
        about="lockstep: every topic has every step; realtime: a step that is missing holds the one before",
        read_only=True,
    )
    duration: float = parameter(
        0.0, unit="s", low=0.0, high=LONGEST, about="the node ends when it holds this time; 0: never", read_only=True
    )
