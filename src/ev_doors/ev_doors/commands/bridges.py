"""Nodes that speak the messages of others: simulation_interfaces, Autoware, ackermann_msgs."""

from __future__ import annotations

import sys
from functools import partial

from ev_doors.bridges import needed
from ev_nodes.run_role import run_node
from ev_nodes.stepping.stop_request import StopRequest
from ev_stack.command_line.refusal import Parser, refuse
from ev_stack.commands.present_graph import in_the_graph, master_namespace
from ev_stack.recording.outcome import RunFailed

_VEHICLES = ("autoware", "ackermann")
_SIMULATION = "simulation_interfaces"
_NEEDED = {  # one of each package
    "autoware": ("autoware_control_msgs/msg/Control", "autoware_vehicle_msgs/msg/GearCommand"),
    "ackermann": ("ackermann_msgs/msg/AckermannDriveStamped",),
    _SIMULATION: ("simulation_interfaces/msg/Result",),
}


def bridge(argv: list[str]) -> None:
    """ev-stack bridge simulation_interfaces | autoware | ackermann [--ros-args ...]"""
    parser = Parser(
        prog="ev-stack bridge",
        description=f"{__doc__} Each where its package is sourced (docs/bridges.md).",
    )
    parser.add_argument(
        "kind",
        choices=[_SIMULATION, *_VEHICLES],
        help="the last two are drivers, as in run.sh --node",
    )
    parser.add_argument(
        "--namespace",
        metavar="/NAME",
        help=f"of the graph, of {_SIMULATION} where a domain has several",
    )
    given, rest = parser.parse_known_args(argv)
    if given.kind in _VEHICLES and given.namespace:
        parser.error(
            f"--namespace is for {_SIMULATION}; that of a driver is -r __ns:=/NAME behind"
            " --ros-args"
        )
    if given.kind == _SIMULATION and rest:
        parser.error(f"unrecognized arguments: {' '.join(rest)}")
    try:
        # Before anything of ROS starts: a missing package is one line.
        for kind in _NEEDED[given.kind]:
            needed(kind)
        if given.kind in _VEHICLES:
            from ev_doors.bridges import vehicle

            # The node reads ROS arguments from the words of the process.
            sys.argv[1:] = rest
            run_node(
                "driver",
                partial(vehicle.CommandedDriver, getattr(vehicle, given.kind.capitalize())),
            )
            return
        from ev_doors.bridges.simulation import SimulationInterfaces

        with StopRequest() as stop, in_the_graph(_SIMULATION) as node:
            SimulationInterfaces(node, master_namespace(node, given.namespace)).spin(
                lambda: stop.received
            )
    except (LookupError, RunFailed, ImportError) as error:
        refuse(error.args[0])
