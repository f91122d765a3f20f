"""Read a speed profile from a CSV file into parameters. Driver and plant themselves open no files."""

from __future__ import annotations

import dataclasses
from typing import TypeVar

from ev_msgs_py.parameters.csv_file import read_csv
from ev_msgs_py.parameters.declaration import flatten
from ev_msgs_py.parameters.values import build
from ev_sim.profiles.speed_profile import SpeedProfileParameters

P = TypeVar("P")  # a parameter dataclass with a group `speed_profile`
_COLUMNS = ({"t_s": 1.0}, {"v_mps": 1.0, "v_kmh": 1 / 3.6})


def with_profile_from_file(parameters: SpeedProfileParameters, name: str = "speed_profile") -> SpeedProfileParameters:
    """The same parameters with `time` [s] and `speed` [m/s] from `file` in place of the file's name.

    `name` is what the parameters are called. Parameters without a file come back as they are. The file is a CSV with a
    header; the columns t_s and one of v_kmh and v_mps are read. Raises ParameterError, in one line that names the file,
    if it cannot be read (`read_csv`) or holds speeds out of range or times that do not increase.
    """

    def profile(time: tuple[float, ...], speed: tuple[float, ...]) -> SpeedProfileParameters:
        return build(SpeedProfileParameters, {**flatten(parameters), "time": time, "speed": speed, "file": ""})

    return read_csv(f"{name}.file", parameters.file, _COLUMNS, profile) if parameters.file else parameters


def with_speed_profile_from_file(parameters: P) -> P:
    """The same parameters of a driver, whose group `speed_profile` comes from its file if it names one."""
    return dataclasses.replace(parameters, speed_profile=with_profile_from_file(parameters.speed_profile))
