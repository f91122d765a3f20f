"""The parameters that every node of the graph has, besides those of its method."""

from __future__ import annotations

from dataclasses import dataclass

from ev_core.parameters.declaration import group, setting
from ev_core.vehicle.description import Vehicle


@dataclass(frozen=True, slots=True)
class CommonParameters:
    """Parameters that every node of the graph has."""

    control_period: float = setting(
        0.01, unit="s", low=1e-4, high=1.0, about="step of the graph, the same for all nodes", read_only=True
    )
    mode: str = setting(
        "lockstep",
        choices=("lockstep", "realtime"),
        about="lockstep: a step when all inputs are there; realtime: a step when the wall clock says so",
        read_only=True,
    )
    seed: int = setting(0, low=0, high=2**31 - 1, about="seed of everything random in the node", read_only=True)
    scheduling_priority: int = setting(
        0, low=0, high=99, about="SCHED_FIFO for all threads of the process; 0: not asked for", read_only=True
    )
    lock_memory: bool = setting(False, about="keep the memory of the node's process from being paged", read_only=True)
    vehicle: Vehicle = group(Vehicle)
