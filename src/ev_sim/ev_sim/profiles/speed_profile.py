"""A speed that somebody wants, over time."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import TypeVar

from ev_core.parameters.data_file import read_csv
from ev_core.law import ParameterError, parameter, setting
from ev_core.parameters.declaration import flatten
from ev_core.parameters.values import build
from ev_sim.profiles.profile import Profile, check_points, interpolation_parameter, profile_of


@dataclass(frozen=True, slots=True)
class SpeedProfileParameters:
    """The speed that the driver wants, over time; the default is that of the paper's cycle."""

    time: tuple[float, ...] = parameter(
        (0.0, 4.0, 25.0, 29.0), unit="s", about="times of the points, increasing", source="Shchur 2019, fig. 4"
    )
    speed: tuple[float, ...] = parameter(
        (0.0, 15 / 3.6, 15 / 3.6, 30 / 3.6),
        unit="m/s",
        low=-100.0,
        high=100.0,
        about="speeds at these times, negative to reverse; the last one holds",
        source="Shchur 2019, fig. 4",
    )
    interpolation: str = interpolation_parameter("linear")
    file: str = setting(
        "", about="CSV file with the columns t_s and v_kmh or v_mps, instead of time and speed; empty for none"
    )

    def __post_init__(self) -> None:
        check_points("time", self.time, "speed", self.speed)


def wanted_speed(parameters: SpeedProfileParameters, name: str = "speed_profile") -> Profile:
    """The speed over time [m/s].

    ParameterError if the parameters, called `name`, still name a file: whoever made them has to read it.
    """
    if parameters.file:
        raise ParameterError(f"{name}.file: {parameters.file} has not been read into time and speed")
    return profile_of(parameters.time, parameters.speed, parameters.interpolation)


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
