"""A value over time, given by points: the wanted speed among them, and the speed cycles.

How it works: a profile is points in time, among which compiled code searches by halving
(`value_at`). A speed profile may name a CSV file. It is read into points before anything runs; what
still names a file then is refused. `cycle_values` makes of the name of a cycle the values that a
scenario takes for it.
"""

from __future__ import annotations

import dataclasses
import os
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple, TypeVar

from ev_core.law import ParameterError, compilable, parameter, setting
from ev_core.parameters.data_file import config_folders, read_csv
from ev_core.parameters.declaration import flatten
from ev_core.parameters.values import build
from ev_msgs_py.refusal import unknown_name

INTERPOLATIONS = BY_LINES, IN_STEPS = "linear", "step"


P = TypeVar("P")  # a parameter dataclass with a group `speed_profile`
_COLUMNS = ({"t_s": 1.0}, {"v_mps": 1.0, "v_kmh": 1 / 3.6})
# Columns of a hill, which is a road of the plant and not of a cycle.
_GRADES = ("grade", "slope", "cycGrade")
LISTED = "trrl_1_1"  # the dissertation lists its windows, and the scenarios with it
_ROOM = 1.1  # length of the road over that of the cycle: a fast driver is somewhat ahead


def interpolation_parameter(default: str) -> str:
    """Declare how a profile goes from point to point."""
    return setting(
        default,
        choices=INTERPOLATIONS,
        about="linear from point to point, or in steps: each value from its time on until the next",
    )


def check_points(
    time_name: str, time: tuple[float, ...], value_name: str, value: tuple[float, ...]
) -> None:
    """Refuse points that are none, lack a value, or do not go on in time."""
    if not time or len(time) != len(value):
        raise ParameterError(
            f"{time_name} and {value_name} have {len(time)} and {len(value)} elements, expected "
            f"the same number,"
            " at least one"
        )
    for earlier, later in pairwise(time):
        if not earlier < later:
            raise ParameterError(
                f"{time_name}: {later:g} s after {earlier:g} s is refused, expected increasing time"
            )


class Profile(NamedTuple):
    """Points in time, increasing [s], and their values in any unit.

    Lines lead from point to point (1), or values hold (0).
    """

    time: tuple[float, ...]
    value: tuple[float, ...]
    linear: float


def profile_of(time: tuple[float, ...], value: tuple[float, ...], interpolation: str) -> Profile:
    """The profile through points; `interpolation` is one of INTERPOLATIONS."""
    return Profile(time, value, float(interpolation == BY_LINES))


@compilable
def value_at(profile: Profile, t: float) -> float:
    """The value at the time t [s]; before the first and after the last point their values hold."""
    after = number_until(profile.time, t)
    if after == 0:
        return profile.value[0]
    start = profile.value[after - 1]
    if profile.linear == 0.0 or after == len(profile.time):
        return start
    begin, end = profile.time[after - 1], profile.time[after]
    return start + (profile.value[after] - start) * ((t - begin) / (end - begin))


@compilable
def number_until(times: tuple[float, ...], t: float) -> int:
    """Number of the increasing times that are not after t."""
    low, high = 0, len(times)
    while low < high:
        middle = (low + high) // 2
        if t < times[middle]:
            high = middle
        else:
            low = middle + 1
    return low


@dataclass(frozen=True, slots=True)
class SpeedProfileParameters:
    """The speed that the driver wants, over time; the default is that of the paper's cycle."""

    time: tuple[float, ...] = parameter(
        (0.0, 4.0, 25.0, 29.0),
        unit="s",
        about="times of the points, increasing",
        source="Shchur 2019, fig. 4",
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
        "",
        about="CSV file with the columns t_s and v_kmh or v_mps, instead of time and speed; empty "
        "for none",
    )

    def __post_init__(self) -> None:
        check_points("time", self.time, "speed", self.speed)


def wanted_speed(parameters: SpeedProfileParameters, name: str = "speed_profile") -> Profile:
    """The speed over time [m/s].

    ParameterError if the parameters, called `name`, still name a file, which has to be read before.
    """
    if parameters.file:
        raise ParameterError(
            f"{name}.file: {parameters.file} has not been read into time and speed"
        )
    return profile_of(parameters.time, parameters.speed, parameters.interpolation)


def with_profile_from_file(
    parameters: SpeedProfileParameters, name: str = "speed_profile"
) -> SpeedProfileParameters:
    """The parameters with `time` [s] and `speed` [m/s] from `file` in place of the file's name.

    `name` is what the parameters are called. Parameters without a file come back as they are. The
    file is a CSV with a header; the columns t_s and one of v_kmh and v_mps are read, times from the
    first row on. Raises ParameterError, in one line that names the file, if it cannot be read
    (`read_csv`), if it has a grade, or if it holds speeds out of range or times that do not
    increase.
    """

    def profile(time: tuple[float, ...], speed: tuple[float, ...]) -> SpeedProfileParameters:
        # Recorded cycles begin at any time, runs at zero.
        if time and time[0] != 0.0:
            time = tuple(each - time[0] for each in time)
        return build(
            SpeedProfileParameters,
            {**flatten(parameters), "time": time, "speed": speed, "file": ""},
        )

    if not parameters.file:
        return parameters
    return read_csv(f"{name}.file", parameters.file, _COLUMNS, profile, _GRADES)


def with_speed_profile_from_file(parameters: P) -> P:
    """The parameters of a driver, with `speed_profile` from its file if it names one."""
    return dataclasses.replace(
        parameters, speed_profile=with_profile_from_file(parameters.speed_profile)
    )


def cycle_values(name: str) -> tuple[list[tuple[str, str, Any]], float]:
    """Values by which a cycle changes a scenario, (node, parameter, value); duration [s].

    `name` is that of a file in config/cycles, its beginning if no other begins so, or the path of a
    CSV file. The windows are then found by rule (`driver.modes`), unless the scenario lists those
    of this cycle, and a random road is as long as the cycle. ParameterError that lists the known
    cycles for an unknown one.
    """
    file = name if os.sep in name or name.endswith(".csv") else f"cycles/{_known(name)}.csv"
    profile = with_profile_from_file(SpeedProfileParameters(file=file), "cycle")
    values: list[tuple[str, str, Any]] = [
        ("driver", "speed_profile.file", file),
        ("plant", "imposed_speed.file", file),
    ]
    if file != f"cycles/{LISTED}.csv":
        points = zip(profile.time, profile.speed, strict=True)
        length = sum(0.5 * abs(v0 + v1) * (t1 - t0) for (t0, v0), (t1, v1) in pairwise(points))
        values += [("driver", "modes.begin", []), ("driver", "modes.mode", [])]
        values += [("plant", "road.random_distance", max(_ROOM * length, 1.0))]
    return values, profile.time[-1]


def cycle_names() -> list[str]:
    """The cycles in the config folders."""
    return sorted(
        {path.stem for folder in config_folders() for path in (folder / "cycles").glob("*.csv")}
    )


def _known(name: str) -> str:
    names = cycle_names()
    # A whole name comes first: it may be the beginning of another one.
    meant = [name] if name in names else [each for each in names if each.startswith(name)]
    if len(meant) != 1:
        raise unknown_name("cycle", name, names)
    return meant[0]
