"""Read a speed profile from a CSV file into the parameters of the driver. The driver itself opens no files."""

from __future__ import annotations

import csv
import dataclasses
import math
from pathlib import Path

from ev_msgs_py.parameters import ParameterError
from ev_sim.driver.speed_control import SpeedProfileParameters

_TIME = "t_s"
_METRES_PER_SECOND = {"v_mps": 1.0, "v_kmh": 1 / 3.6}


def with_profile_from_file(parameters: SpeedProfileParameters, directory: Path = Path()) -> SpeedProfileParameters:
    """The same parameters with `time` [s] and `speed` [m/s] from `file` in place of the file's name.

    Parameters without a file come back as they are. A relative name counts from `directory`. The file is a CSV with
    a header; the columns t_s and one of v_kmh and v_mps are read. Raises ParameterError, in one line that names the
    file, if it cannot be read, lacks a column, holds something else than finite numbers or times that do not increase.
    """
    if not parameters.file:
        return parameters
    path = directory / parameters.file
    try:
        time, speed = _read(path)
        return dataclasses.replace(parameters, time=time, speed=speed, file="")
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        reason = error.strerror if isinstance(error, OSError) else "no CSV text"
        raise ParameterError(f"speed_profile.file: {path}: {reason}") from None
    except ParameterError as error:
        raise ParameterError(f"speed_profile.file: {path}: {error}") from None


def _read(path: Path) -> tuple[tuple[float, ...], tuple[float, ...]]:
    with path.open(newline="", encoding="utf-8-sig") as file:
        rows = csv.DictReader(file, skipinitialspace=True)
        columns = rows.fieldnames or ()
        speeds = [name for name in _METRES_PER_SECOND if name in columns]
        if _TIME not in columns or len(speeds) != 1:
            raise ParameterError(
                f"has the columns {', '.join(columns) or '(none)'}, needed are {_TIME} and one of"
                f" {' and '.join(_METRES_PER_SECOND)}"
            )
        unit = _METRES_PER_SECOND[speeds[0]]
        points = [
            (_number(row[_TIME], _TIME, rows.line_num), unit * _number(row[speeds[0]], speeds[0], rows.line_num))
            for row in rows
        ]
    return tuple(time for time, _ in points), tuple(speed for _, speed in points)


def _number(text: str | None, column: str, line: int) -> float:
    try:
        value = float(text or "")
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ParameterError(f"line {line}: {column} is {text!r}, allowed is a finite number")
    return value
