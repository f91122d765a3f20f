"""Scenarios and vehicles by name: their files, and what the file of a vehicle has to state."""

from __future__ import annotations

import os
from pathlib import Path

from ev_core.parameters.data_file import files_in_config, refuse_outside
from ev_core.parameters.declaration import entries
from ev_core.parameters.values import build
from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.files import with_files
from ev_msgs_py.refusal import ParameterError, quoted, unknown_name
from ev_stack.scenarios.parameter_file import ParameterFile

VEHICLE = "vehicle"
OF_VEHICLE = f"{VEHICLE}."  # how the names of its parameters begin
_ANY_NODE = "/ev/plant"  # all nodes have the parameters of the vehicle


def is_path(name: str) -> bool:
    """True if a file is meant, and no name: a name has neither folder nor suffix."""
    return os.sep in name or name.endswith((".yaml", ".yml"))


def configured_file(kind: str, name: str) -> Path:
    """The file of a scenario or a vehicle in the config folders, or any other by its path.

    ParameterError that lists the known ones for an unknown name.
    """
    if is_path(name):
        refuse_outside(name, Path(name))
        return Path(name)
    known = files_in_config(f"{kind}s")
    if name not in known:
        raise unknown_name(kind, name, known)
    return known[name]


def scenario_names() -> list[str]:
    """Names of all scenarios in the config folders."""
    return sorted(files_in_config("scenarios"))


def vehicle_file(name: str) -> ParameterFile:
    """The vehicle of a name or a path.

    ParameterError that lists what is missing if the file does not state everything in which cars
    differ: it would be filled up from another car; and for whatever else it states, which the
    scenario would overrule in silence.
    """
    file = ParameterFile(configured_file(VEHICLE, name))
    others = sorted(each for each in file.names() if not each.startswith(OF_VEHICLE))
    if others:
        raise ParameterError(
            f"{file.path}: parameter {quoted(others[0])} is no vehicle's, "
            f"expected those of {VEHICLE}; others stand in a scenario"
        )
    stated = file.values_for(_ANY_NODE)
    own = [entry.name for entry in entries(Vehicle, OF_VEHICLE) if entry.spec.own]
    missing = [each for each in own if each not in stated]
    if missing:
        raise ParameterError(
            f"{file.path}: a vehicle says everything about itself, missing: {', '.join(missing)}"
        )
    return file


def vehicle_of(name: str) -> Vehicle:
    """The vehicle itself, its files read; ParameterError if there is none or it is refused."""
    values = vehicle_file(name).values_for(_ANY_NODE)
    return with_files(build(Vehicle, values, OF_VEHICLE))
