"""ev-stack schema: what scenario, vehicle and parameter files may say, as a JSON Schema for editors."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from typing import Any

from ev_core.methods.common_parameters import CommonParameters
from ev_core.methods.register import methods_of
from ev_core.nodes.master.real_time import MasterParameters
from ev_core.parameters.declaration import Entry, Spec, entries
from ev_core.parameters.values import units_for
from ev_core.sensors.row import sensors_for
from ev_msgs_py.contract.roles import MASTER, ROLES
from ev_sim.scenarios.about import ScenarioParameters

_NUMBER = r"^\s*[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\s*"
_TYPES = {float: "number", int: "integer", bool: "boolean", str: "string"}


def main(argv: list[str] | None = None) -> None:
    """ev-stack schema"""
    print(json.dumps(schema(), indent=1, ensure_ascii=False))


def schema() -> dict[str, Any]:
    """Sections by the node that they end with; `/**` and names of runs alone mean every node."""
    definitions = {role: _parameters(_entries(role)) for role in ROLES}
    everything = {entry.name: entry for role in ROLES for entry in _entries(role)}
    definitions["every node"] = _parameters(everything.values())
    definitions["scenario"] = _parameters(entries(ScenarioParameters))
    for role in (*ROLES, "every node"):  # one car for all: written down once
        definitions["vehicle"] = definitions[role]["properties"]["vehicle"]
        definitions[role]["properties"]["vehicle"] = {"$ref": "#/$defs/vehicle"}
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
    of = {"$ref": f"#/$defs/{name.replace(' ', '%20')}"}
    return {"type": "object", "properties": {"ros__parameters": of}, "required": ["ros__parameters"]}


def _entries(role: str) -> list[Entry]:
    """All that a node of a role may be told, whatever its method."""
    found = {entry.name: entry for method in methods_of(role).values() for entry in entries(method.parameters)}
    rest = [*entries(CommonParameters), *(entries(MasterParameters) if role == MASTER else ())]
    rest += entries(sensors_for(ROLES[role].writes), "sensors.")
    method = Entry("method", str, False, "", Spec(f"how the {role} works", choices=tuple(methods_of(role))))
    return [method, *rest, *found.values()]


def _parameters(of: Iterable[Entry]) -> dict[str, Any]:
    """Groups as objects; dotted names are let through, the stack itself knows them."""
    tree = _group()
    for entry in of:
        place, names = tree, entry.name.split(".")
        for group in names[:-1]:
            place = place["properties"].setdefault(group, _group())
        place["properties"][names[-1]] = _value(entry)
    return tree


def _group() -> dict[str, Any]:
    return {"type": "object", "properties": {}, "patternProperties": {r"\.": True}, "additionalProperties": False}


def _value(entry: Entry) -> dict[str, Any]:
    spec = entry.spec
    unit = f" [{spec.unit}]" if spec.unit else ""
    limits = {"minimum": spec.low, "maximum": spec.high, "enum": list(spec.choices) or None}
    kind: dict[str, Any] = {"type": _TYPES[entry.type], **{k: v for k, v in limits.items() if v is not None}}
    if "off" in spec.choices:
        kind = {"enum": [*spec.choices, False]}  # YAML 1.1 reads a bare `off` as false
    if entry.type is float and (units := units_for(spec.unit)):
        with_unit = {"type": "string", "pattern": f"{_NUMBER}({'|'.join(map(re.escape, units))})\\s*$"}
        kind = {"anyOf": [kind, with_unit]}
    if entry.is_array:
        kind = {"type": "array", "items": kind}
    return {"description": f"{spec.about}{unit}", **kind}
