"""The file that is meant by the name of a scenario or a vehicle, or by its path; a vehicle of your own is whole."""

from __future__ import annotations

import os
from pathlib import Path

from ev_msgs_py.parameters.config_folders import files_in_config
from ev_msgs_py.parameters.data_file import refuse_outside
from ev_msgs_py.parameters.declaration import ParameterError, entries
from ev_msgs_py.parameters.shown import quoted
from ev_msgs_py.parameters.values import unknown_name
from ev_msgs_py.vehicle.description import Vehicle
from ev_sim.running.scenarios.parameter_file import ParameterFile

VEHICLE = "vehicle"


def is_path(name: str) -> bool:
    """Whether a file is meant, and no name: a name has neither folder nor suffix."""
    return os.sep in name or name.endswith((".yaml", ".yml"))


def configured_file(kind: str, name: str) -> Path:
    """The file of a scenario or a vehicle in the config folders, or by its path any other that may be named.

    ParameterError that lists the known ones for an unknown name.
    """
    if is_path(name):
        refuse_outside(name, Path(name))
        return Path(name)
    known = files_in_config(f"{kind}s")
    if name not in known:
        raise unknown_name(kind, name, known)
    return known[name]


def vehicle_file(name: str) -> ParameterFile:
    """The vehicle of a name or a path.

    ParameterError that lists what is missing if the file does not say everything in which cars differ: it would be
    filled up from another car; and for whatever else it says, which the scenario would overrule without a word.
    """
    file = ParameterFile(configured_file(VEHICLE, name))
    if others := sorted(each for each in file.names() if not each.startswith(f"{VEHICLE}.")):
        what = (
            f"parameter {quoted(others[0])} is no vehicle's, allowed are those of {VEHICLE}; others stand in a scenario"
        )
        raise ParameterError(f"{file.path}: {what}")
    said = file.values_for("/ev/plant")
    own = [entry.name for entry in entries(Vehicle, f"{VEHICLE}.") if entry.spec.own]
    if missing := [each for each in own if each not in said]:
        raise ParameterError(f"{file.path}: a vehicle says everything about itself, missing: {', '.join(missing)}")
    return file
