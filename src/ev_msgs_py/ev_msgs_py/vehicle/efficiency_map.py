"""Read the efficiency map of a motor from a CSV file into the vehicle description, which every node shares."""

from __future__ import annotations

import dataclasses
import math
from collections import Counter

from ev_msgs_py.parameters.csv_file import read_csv
from ev_msgs_py.parameters.declaration import ParameterError, flatten
from ev_msgs_py.parameters.values import build
from ev_msgs_py.vehicle.description import Vehicle
from ev_msgs_py.vehicle.motor import Motor

_COLUMNS = ({"speed_radps": 1.0, "speed_rpm": math.pi / 30}, {"torque_nm": 1.0}, {"efficiency": 1.0})


def with_map_from_file(vehicle: Vehicle) -> Vehicle:
    """The same vehicle with the efficiency map of its motor from `map_file` in place of the file's name.

    A vehicle without a file comes back as it is. The file is a CSV with a header; the columns torque_nm, efficiency and
    one of speed_radps and speed_rpm are read, one row for each pair of a shaft speed and a torque, in any order. Raises
    ParameterError, in one line that names the file, if it cannot be read (`read_csv`), holds values out of range, or
    pairs are missing or there twice.
    """
    motor = vehicle.motor

    def mapped(*points: tuple[float, ...]) -> Motor:
        return build(Motor, {**flatten(motor), **_grid(*points), "map_file": ""})

    if not motor.map_file:
        return vehicle
    return dataclasses.replace(vehicle, motor=read_csv("vehicle.motor.map_file", motor.map_file, _COLUMNS, mapped))


def _grid(
    speed: tuple[float, ...], torque: tuple[float, ...], efficiency: tuple[float, ...]
) -> dict[str, tuple[float, ...]]:
    """The map's axes and rows from single points."""
    times = Counter(zip(speed, torque, strict=True))
    speeds, torques = sorted(set(speed)), sorted(set(torque))
    grid = [(s, t) for s in speeds for t in torques]
    for s, t in grid:
        if times[s, t] != 1:
            point = f"the point of {s:g} rad/s and {t:g} N m"
            raise ParameterError(f"{point} is there {times[s, t]} times, allowed is once")
    value = dict(zip(zip(speed, torque, strict=True), efficiency, strict=True))
    return {
        "map_speed": tuple(speeds),
        "map_torque": tuple(torques),
        "map_efficiency": tuple(value[point] for point in grid),
    }
