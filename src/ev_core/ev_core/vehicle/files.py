"""Files that a vehicle description names, read into it.

Efficiency maps (CSV) and tyre property files (.tir).
"""

import dataclasses
import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from itertools import product
from typing import Any

from ev_core.parameters.data_file import TEXT, find_file, read_csv, read_data
from ev_core.parameters.declaration import flatten
from ev_core.parameters.values import build
from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.driveline import AXLES
from ev_core.vehicle.motor import Motor
from ev_core.vehicle.tmeasy import TMEASY_NAMES
from ev_core.vehicle.tyre import MF_NAMES, OPTIONAL
from ev_msgs_py.refusal import ParameterError, quoted

_COLUMNS = (
    {"speed_radps": 1.0, "speed_rpm": math.pi / 30},
    {"torque_nm": 1.0},
    {"efficiency": 1.0},
)
# Which formula a file is meant for, by FITTYP, and whether it takes the tangent of the slip angle.
_FIT_TYPES = {6.0: False, 21.0: False, 52.0: False, 60.0: True, 61.0: True, 62.0: True}
_FORMATS = {"PAC2002": False, "MF_05": False}
# The scale factors that multiply a coefficient.
_SCALED = {
    **{
        "LFZO": "fnomin",
        "LCX": "pcx1",
        "LMUX": "pdx1 pdx2",
        "LEX": "pex1 pex2 pex3",
        "LKX": "pkx1 pkx2",
    },
    **{
        "LCY": "pcy1",
        "LMUY": "pdy1 pdy2",
        "LEY": "pey1 pey2",
        "LKY": "pky1",
        "LXAL": "rbx1",
        "LYKA": "rby1",
    },
}
# By coefficient, what multiplies it at another pressure than the nominal one: 1 + these times the
# relative change and its square. They are those of an upright tyre.
_BY_PRESSURE = {
    **dict.fromkeys(("pkx1", "pkx2"), ("PPX1", "PPX2")),
    **dict.fromkeys(("pdx1", "pdx2"), ("PPX3", "PPX4")),
    **dict.fromkeys(("pdy1", "pdy2"), ("PPY3", "PPY4")),
    **{"pky1": ("PPY1", ""), "pky2": ("PPY2", "")},
}
_UNITS = {"LENGTH": "meter", "FORCE": "newton", "ANGLE": "radians"}


def with_map_from_file(vehicle: Vehicle) -> Vehicle:
    """The vehicle with the efficiency map of `map_file` in place of the file's name.

    A vehicle without a file comes back as it is. The file is a CSV with a header; the columns
    torque_nm, efficiency and one of speed_radps and speed_rpm are read, one row for each pair of a
    shaft speed and a torque, in any order. Raises ParameterError, in one line that names the file,
    if it cannot be read (`read_csv`), holds values out of range, or pairs are missing or there
    twice.
    """
    motor = vehicle.motor

    def mapped(*points: tuple[float, ...]) -> Motor:
        return build(Motor, {**flatten(motor), **_grid(*points), "map_file": ""})

    if not motor.map_file:
        return vehicle
    return dataclasses.replace(
        vehicle, motor=read_csv("vehicle.motor.map_file", motor.map_file, _COLUMNS, mapped)
    )


def _grid(
    speed: tuple[float, ...], torque: tuple[float, ...], efficiency: tuple[float, ...]
) -> dict[str, tuple[float, ...]]:
    """The map's axes and rows from single points."""
    points = list(zip(speed, torque, strict=True))
    times = Counter(points)
    value = dict(zip(points, efficiency, strict=True))
    speeds = sorted(set(speed))
    torques = sorted(set(torque))
    rows: list[float] = []
    for s, t in product(speeds, torques):
        # The map is a grid without holes, as the plant interpolates in it.
        if times[s, t] != 1:
            point = f"the point of {s:g} rad/s and {t:g} N m"
            raise ParameterError(f"{point} is there {times[s, t]} times, expected once")
        rows.append(value[s, t])
    return {
        "map_speed": tuple(speeds),
        "map_torque": tuple(torques),
        "map_efficiency": tuple(rows),
    }


_SCALES = {name: scale for scale, names in _SCALED.items() for name in names.split()}


def with_tyres_from_files(vehicle: Vehicle) -> Vehicle:
    """The vehicle with the coefficients of its tyres' files in place of their names.

    A vehicle without a file comes back as it is. Raises ParameterError, in one line that names the
    file, if it cannot be read, is meant for another formula or in other units, lacks a coefficient
    or holds no number.
    """
    tyre = vehicle.tyre
    numbers, array = (tmeasy_numbers, "tmeasy") if tyre.curve == "tmeasy" else (mf_numbers, "mf")
    for axle in AXLES:
        if file := getattr(tyre, f"{axle}_file"):
            read: dict[str, Any] = {
                f"{axle}_{array}": read_tyre(f"vehicle.tyre.{axle}_file", file, numbers),
                f"{axle}_file": "",
            }
            tyre = dataclasses.replace(tyre, **read)
    return dataclasses.replace(vehicle, tyre=tyre)


def mf_numbers(entries: Mapping[str, str]) -> tuple[float, ...]:
    """The numbers of MfTyres from the entries of a file, scaled and at its pressure.

    ParameterError if some lack.
    """
    _refuse_units(entries)
    takes_tangent = _takes_tangent(entries)
    needed = [name for name in MF_NAMES if name != "takes_tangent"]
    _refuse_lacking(entries, (name for name in needed if name not in OPTIONAL))
    change = _pressure_change(entries)
    return (*(_coefficient(entries, name, change) for name in needed), float(takes_tangent))


def tmeasy_numbers(entries: Mapping[str, str]) -> tuple[float, ...]:
    """The numbers in the order of TMEASY_NAMES from the entries of a file of ours.

    ParameterError if some lack. TMeasy has no file format that is common to its programs.
    """
    _refuse_units(entries)
    written = entries.get("PROPERTY_FILE_FORMAT", "")
    if written != "TMEASY":
        raise ParameterError(f"PROPERTY_FILE_FORMAT is {quoted(written)}, expected 'TMEASY'")
    _refuse_lacking(entries, TMEASY_NAMES)
    return tuple(_number(entries, name.upper(), 0.0) for name in TMEASY_NAMES)


def read_tyre(
    parameter: str,
    name: str,
    numbers: Callable[[Mapping[str, str]], tuple[float, ...]] = mf_numbers,
) -> tuple[float, ...]:
    """The `numbers` that the entries of a tyre property file give.

    ParameterError, see `with_tyres_from_files`.
    """
    try:
        return numbers(_entries(read_data(find_file(name), TEXT).decode("latin-1")))
    except OSError as error:
        raise ParameterError(f"{parameter}: {name}: {error.strerror or error}") from None
    except ParameterError as error:
        raise ParameterError(f"{parameter}: {name}: {error}") from None


def _refuse_units(entries: Mapping[str, str]) -> None:
    for unit, wanted in _UNITS.items():
        given = entries.get(unit, wanted).lower()
        if given.rstrip("s") != wanted.rstrip("s"):
            raise ParameterError(f"{unit} is {quoted(given)}, expected {quoted(wanted)}")


def _refuse_lacking(entries: Mapping[str, str], needed: Iterable[str]) -> None:
    lacking = [name.upper() for name in needed if name.upper() not in entries]
    if lacking:
        raise ParameterError(f"lacks {', '.join(lacking)}")


def _pressure_change(entries: Mapping[str, str]) -> float:
    """Relative excess of the inflation pressure over the nominal one [1].

    0 where a file has not both.
    """
    if "INFLPRES" not in entries or "NOMPRES" not in entries:
        return 0.0
    given = _number(entries, "INFLPRES", 0.0)
    nominal = _number(entries, "NOMPRES", 0.0)
    for key, value in (("INFLPRES", given), ("NOMPRES", nominal)):
        if value <= 0.0:
            raise ParameterError(f"{key} is {value:g}, expected above 0")
    return given / nominal - 1.0


def _takes_tangent(entries: Mapping[str, str]) -> bool:
    if "FITTYP" in entries:
        kind = _number(entries, "FITTYP", 0.0)
        if kind not in _FIT_TYPES:
            known = ", ".join(f"{each:g}" for each in _FIT_TYPES)
            raise ParameterError(f"FITTYP is {kind:g}, expected one of {known}")
        return _FIT_TYPES[kind]
    written = entries.get("PROPERTY_FILE_FORMAT", "")
    if written not in _FORMATS:
        known = ", ".join(_FORMATS)
        raise ParameterError(
            f"PROPERTY_FILE_FORMAT is {quoted(written)} without FITTYP, expected one of {known}"
        )
    return _FORMATS[written]


def _coefficient(entries: Mapping[str, str], name: str, pressure_change: float) -> float:
    value = _number(entries, name.upper(), OPTIONAL.get(name, 0.0))
    if name in _SCALES:
        value *= _number(entries, _SCALES[name], 1.0)
    if name in _BY_PRESSURE:
        linear, squared = (_number(entries, key, 0.0) for key in _BY_PRESSURE[name])
        value *= 1.0 + linear * pressure_change + squared * pressure_change**2
    # Slip angle and side force have one sign or the other by the axes of the file; the tyre opposes
    # its slip in all.
    if name.startswith("pdy") and _number(entries, "PDY1", 1.0) < 0.0:
        return -value
    return abs(value) if name == "pky1" else value


def _number(entries: Mapping[str, str], key: str, default: float) -> float:
    text = entries.get(key)
    if text is None:
        return default
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ParameterError(f"{key} is {quoted(text)}, expected one finite number")
    return value


def _entries(text: str) -> dict[str, str]:
    """KEY = value of all sections; $ begins a comment, a line of ! is one.

    Of a key with different values both stand in its text, which is no number where one is read:
    MASS is a unit in one section and a mass in another, and nothing here reads it.
    """
    found: dict[str, str] = {}
    for line in text.splitlines():
        if "=" in line and not line.lstrip().startswith(("!", "$")):
            key, _, value = line.partition("=")
            key, value = key.strip().upper(), value.partition("$")[0].strip().strip("'\"").strip()
            found[key] = value if found.get(key, value) == value else f"{found[key]} and {value}"
    return found


def with_files(vehicle: Vehicle) -> Vehicle:
    """The vehicle with the numbers of its files in place of their names.

    ParameterError, in one line, as they raise.
    """
    return with_tyres_from_files(with_map_from_file(vehicle))
