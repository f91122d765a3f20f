"""Parameters that every node of the graph has besides those of its method."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from ev_core.faults.fault import FaultParameters
from ev_core.parameters.declaration import entries, group, setting
from ev_core.parameters.values import entries_by_name
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.refusal import ParameterError

SENSORS = "sensors"  # the group of a node's sensors
# parameters and groups of ROS itself
OF_ROS = ("use_sim_time", "start_type_description_service", "qos_overrides")
(FAULTS,) = entries(FaultParameters)


@dataclass(frozen=True, slots=True)
class CommonParameters:
    """Parameters that every node of the graph has."""

    control_period: float = setting(
        0.01,
        unit="s",
        low=1e-4,
        high=1.0,
        about="step of the graph, the same for all nodes",
        read_only=True,
    )
    mode: str = setting(
        "lockstep",
        choices=("lockstep", "realtime"),
        about="lockstep: a step when all inputs are there; realtime: a step when the wall clock "
        "says so",
        read_only=True,
    )
    seed: int = setting(
        0, low=0, high=2**31 - 1, about="seed of everything random in the node", read_only=True
    )
    scheduling_priority: int = setting(
        0,
        low=0,
        high=99,
        about="SCHED_FIFO for all threads of the process; 0: not asked for",
        read_only=True,
    )
    lock_memory: bool = setting(
        False, about="keep the memory of the node's process from being paged", read_only=True
    )
    vehicle: Vehicle = group(Vehicle)


def refuse_taken(label: str, parameters: type, taken: Iterable[str] = ()) -> None:
    """ParameterError if a parameter has the name of one that every node has, or one of `taken`.

    It would not get there. Only a method with the `faults` of every node may ask for them itself.
    """
    own = entries_by_name(parameters)
    of_nodes = entries_by_name(CommonParameters)
    groups = {"method", SENSORS, *OF_ROS, *(name.partition(".")[0] for name in of_nodes)}
    for name, entry in own.items():
        is_fault = name == FAULTS.name and entry != FAULTS
        if name.partition(".")[0] in groups or name in taken or is_fault:
            raise ParameterError(
                f"{label}: parameter {name} is refused: every node has one of this name, take "
                "another"
            )
