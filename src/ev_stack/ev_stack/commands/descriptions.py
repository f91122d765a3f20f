"""Descriptions for other tools: schemas, cars as URDF, parameters of nodes, the C interface."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from ev_core.methods.common_parameters import CommonParameters
from ev_core.methods.register import methods_of
from ev_core.parameters.data_file import config_folders
from ev_core.parameters.declaration import Entry, Spec, entries
from ev_core.parameters.section import ANY_NAMESPACE
from ev_core.parameters.values import units_for
from ev_core.sensors.row import sensors_for
from ev_msgs_py.contract.roles import MASTER, ROLES
from ev_msgs_py.refusal import ParameterError
from ev_nodes.master.real_time import MasterParameters
from ev_stack.command_line.options import add_overrides, overrides
from ev_stack.command_line.paths import add_out
from ev_stack.command_line.refusal import Parser, refuse
from ev_stack.recording.outcome import RunFailed
from ev_stack.recording.recording import PARAMETERS
from ev_stack.scenarios.about import ScenarioParameters
from ev_stack.scenarios.files import vehicle_of

_ABOUT_PARAMETERS = """
ev-stack parameters SCENARIO: all parameters of every node of a run, as a ROS parameter file, and how it is started. For
starting nodes by other means than scripts/run.sh, such as launch files (launch/scenario.launch.py).
"""
_NUMBER = r"^\s*[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\s*"
_TYPES = {float: "number", int: "integer", bool: "boolean", str: "string"}


def print_header(argv: list[str]) -> None:
    """ev-stack header"""
    from ev_core.native.interface import header

    print(header(), end="")


def print_urdf(argv: list[str]) -> None:
    """ev-stack urdf VEHICLE"""
    from ev_stack.views.urdf import urdf

    parser = Parser(prog="ev-stack urdf", description="A car as URDF, for RViz and Foxglove.")
    parser.add_argument("vehicle", help="name of a vehicle, or path of a vehicle file")
    try:
        car = vehicle_of(parser.parse_args(argv).vehicle)
    except (ParameterError, OSError) as error:
        refuse(error)
    print(urdf(car), end="")


def write_parameters(argv: list[str]) -> None:
    """ev-stack parameters SCENARIO [--out DIR]; standard output is JSON."""
    from ev_stack.interface.driving import only_run
    from ev_stack.running.node_process import package_of
    from ev_stack.running.offline import node_parameters, write_parameter_file
    from ev_stack.running.output_folder import output_folder

    parser = Parser(prog="ev-stack parameters", description=_ABOUT_PARAMETERS)
    parser.add_argument("scenario", help="name or path of a scenario")
    parser.add_argument(
        "--run", default="", metavar="NAME", help="which of its runs, if it has several"
    )
    parser.add_argument(
        "--realtime", action="store_true", help="by the wall clock instead of in lockstep"
    )
    add_overrides(parser)
    parser.add_argument("--no-record", action="store_true", help="no bag")
    add_out(parser, "SCENARIO")
    given = parser.parse_args(argv)
    try:
        run = only_run(given.scenario, given.run, overrides(given))
        with output_folder(given.out, run.name) as folder:
            nodes = node_parameters(run, folder, bag=not given.no_record)
            file = folder / PARAMETERS
            # A launch file may start the nodes in any namespace.
            write_parameter_file(file, replace(run, namespace=ANY_NAMESPACE), nodes)
        started = [{"package": package_of(name), "executable": name} for name in nodes]
    except (ParameterError, RunFailed, LookupError, OSError) as error:
        refuse(error)
    layout = config_folders()[-1] / "layouts" / "car.rviz"
    started_by = {
        "namespace": run.namespace,
        "parameters": str(file),
        "nodes": started,
        "rviz": str(layout),
    }
    print(json.dumps(started_by, indent=2))


def print_schema(argv: list[str]) -> None:
    """ev-stack schema"""
    print(json.dumps(schema(), indent=1, ensure_ascii=False))


def schema() -> dict[str, Any]:
    """Sections by the node that they end with; `/**` and names of runs alone mean every node."""
    definitions = {role: _node(_entries(role)) for role in ROLES}
    everything = {entry.name: entry for role in ROLES for entry in _entries(role)}
    definitions["every node"] = _node(everything.values())
    definitions["scenario"] = _node(entries(ScenarioParameters))
    for role in (*ROLES, "every node"):  # one car for all: written down once
        definitions["vehicle"] = definitions[role]["properties"]["vehicle"]
        definitions[role]["properties"]["vehicle"] = {"$ref": "#/$defs/vehicle"}
    # A section means a node by the last part of its name, a `*` there any node.
    sections = {rf"(^|/){name}$": _section(name) for name in (*ROLES, "scenario")}
    sections[r"\*$"] = _section("every node")
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Scenario, vehicle or parameter file of the EV control stack",
        "type": "object",
        "patternProperties": sections,
        "$defs": definitions,
    }


def _section(name: str) -> dict[str, Any]:
    # A reference is a URI, in which a blank is %20.
    of = {"$ref": f"#/$defs/{name.replace(' ', '%20')}"}
    return {
        "type": "object",
        "properties": {"ros__parameters": of},
        "required": ["ros__parameters"],
    }


def _entries(role: str) -> list[Entry]:
    """All parameters that a node of a role may have, whatever its method."""
    found = {
        entry.name: entry
        for method in methods_of(role).values()
        for entry in entries(method.parameters)
    }
    rest = [*entries(CommonParameters), *(entries(MasterParameters) if role == MASTER else ())]
    rest += entries(sensors_for(ROLES[role].writes), "sensors.")
    method = Entry(
        "method", str, False, "", Spec(f"how the {role} works", choices=tuple(methods_of(role)))
    )
    return [method, *rest, *found.values()]


def _node(of: Iterable[Entry]) -> dict[str, Any]:
    """Groups as objects; dotted names are let through, the stack itself knows them.

    A name may be a group of one method and a value of another.
    """
    tree = _group()
    for entry in of:
        *groups, name = entry.name.split(".")
        place = tree["properties"]
        for group in groups:
            place = _within(place, group)["properties"]
        place[name] = {"anyOf": [_value(entry), place[name]]} if name in place else _value(entry)
    return tree


def _within(properties: dict[str, Any], name: str) -> dict[str, Any]:
    found = properties.setdefault(name, _group())
    # The name may already be a value of another method: then the group stands beside it.
    for each in found.get("anyOf", (found,)):
        if "properties" in each:
            return each
    group = _group()
    properties[name] = {"anyOf": [found, group]}
    return group


def _group() -> dict[str, Any]:
    return {
        "type": "object",
        "properties": {},
        "patternProperties": {r"\.": True},
        "additionalProperties": False,
    }


def _value(entry: Entry) -> dict[str, Any]:
    spec = entry.spec
    unit = f" [{spec.unit}]" if spec.unit else ""
    limits = {"minimum": spec.low, "maximum": spec.high, "enum": list(spec.choices) or None}
    kind: dict[str, Any] = {
        "type": _TYPES[entry.type],
        **{k: v for k, v in limits.items() if v is not None},
    }
    if "off" in spec.choices:
        kind = {"enum": [*spec.choices, False]}  # YAML 1.1 reads a bare `off` as false
    # A number, or a text of a number and a unit that can be converted, such as '50 km/h'.
    if entry.type is float and (units := units_for(spec.unit)):
        with_unit = {
            "type": "string",
            "pattern": f"{_NUMBER}({'|'.join(map(re.escape, units))})\\s*$",
        }
        kind = {"anyOf": [kind, with_unit]}
    if entry.is_array:
        kind = {"type": "array", "items": kind}
    return {"description": f"{spec.about}{unit}", **kind}
