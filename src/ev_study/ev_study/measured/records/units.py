"""Units of the columns of a record: that of the mapping, that which the file has, or SI, held against the channel."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

from ev_msgs_py.contract import frame
from ev_msgs_py.refusal import ParameterError, quoted
from ev_study.measured.records.record import SIDESLIP, UNITS, ColumnParameters

# By SI unit, as the contract has it, the units of `UNITS` that measure the same.
_SAME = {
    "1": ("1",),
    "s": ("s", "ms", "us"),
    "m": ("m", "cm"),
    "m/s": ("m/s", "km/h", "mph"),
    "m/s^2": ("m/s2", "g"),
    "rad": ("rad", "deg"),
    "rad/s": ("rad/s", "deg/s", "rpm"),
    "N": ("N", "kN"),
    "N m": ("N m",),
    "degC": ("degC",),
    "W": ("W",),
    "kPa": ("kPa",),  # of no channel, but of rigs
}
# How the same units are written in CAN databases and in the headers of loggers, in lower case.
_WRITTEN = {
    **{unit.lower(): unit for units in _SAME.values() for unit in units},
    **dict.fromkeys(("kph", "kmh", "kmph", "km/hr", "km/hour"), "km/h"),
    **dict.fromkeys(("m/sec", "mps"), "m/s"),
    **dict.fromkeys(("m/s^2", "m/s²", "m/s/s", "m/sec^2", "m/s**2"), "m/s2"),
    **dict.fromkeys(("°", "degree", "degrees", "grad"), "deg"),
    **dict.fromkeys(("°/s", "deg/sec", "degree/s", "degrees/s", "dps", "°/sec"), "deg/s"),
    **dict.fromkeys(("radians", "radian"), "rad"),
    **dict.fromkeys(("rad/sec", "radian/s", "1/s"), "rad/s"),
    # u/min is German, as "grad" above.
    **dict.fromkeys(("1/min", "r/min", "u/min", "min-1", "min^-1"), "rpm"),
    **dict.fromkeys(("nm", "n*m", "n.m", "n·m", "n-m"), "N m"),
    **dict.fromkeys(("°c", "c", "deg c"), "degC"),
    **dict.fromkeys(("sec", "seconds"), "s"),
}
# Brackets at the end of a name, round or square.
_BRACKETS = re.compile(r"[\[(]([^\[\]()]*)[\])]$")
# what a file writes for a number without a unit, or for one that it does not know
_NONE = ("", "-", "1")


def of_header(columns: Iterable[str]) -> dict[str, str]:
    """Units in brackets at the ends of column names, as of "speed [km/h]"."""
    found = {name: match[1] for name in columns if (match := _BRACKETS.search(name))}
    return {name: unit for name, unit in found.items() if unit.strip().lower() in _WRITTEN}


def refuse_other_units(file: Path, units: Mapping[str, str], expected: Mapping[str, str]) -> None:
    """ParameterError if a file with a fixed format has a row of units with another one than its format has."""
    for column, unit in expected.items():
        written = units.get(column, "").strip()
        if written not in _NONE and _WRITTEN.get(written.lower(), written) != unit:
            raise ParameterError(f"{file}: {column} is in {quoted(written)}, expected {unit}")


def with_unit(name: str, declared: ColumnParameters, of_file: str) -> ColumnParameters:
    """The same column with the unit of its numbers.

    `of_file` is the text that the file has for it, or empty.

    ParameterError if mapping and file contradict each other, or if the unit does not measure what
    the channel is.
    """
    channel_unit = {**frame.units(), SIDESLIP: "rad", "time": "s"}[name]
    # None for a text that is no known unit, empty for none at all.
    known = "" if of_file.strip() in _NONE else _WRITTEN.get(of_file.strip().lower())
    given = declared.unit
    if not given and known is None:
        raise ParameterError(
            f"{declared.column} has the unit {quoted(of_file)} in the file, expected one of"
            f" {', '.join(UNITS)[2:]}, or `unit` in the mapping"
        )
    # By name: units of different quantities may have the same factor to SI.
    if given and known and given != known:
        raise ParameterError(
            f"{declared.column} is in {given} by the mapping and in {quoted(of_file)} by the file,"
            " expected the same"
        )
    unit = given or known or ""
    allowed = _SAME.get(channel_unit, ("1",))
    if declared.radius and name.startswith("wheel_states.velocity."):
        allowed = _SAME["m/s"]
    elif declared.radius:
        raise ParameterError("radius is refused, expected only for wheel_states.velocity")
    if unit and unit not in allowed:
        by_radius = (
            ", or the radius of the wheel beside a speed"
            if name.startswith("wheel_states.velocity.")
            else ""
        )
        raise ParameterError(f"the unit is {unit}, expected {', '.join(allowed)}{by_radius}")
    return replace(declared, unit=unit)


def without_unit(
    units: Mapping[str, str], declared: Mapping[str, ColumnParameters]
) -> tuple[str, ...]:
    """One note for each column that neither the mapping nor a file with units gives one."""
    # A reader without any units (a bag) has no such notes: its messages define theirs.
    si = {**frame.units(), SIDESLIP: "rad"}
    notes = []
    for name, each in declared.items():
        if not each.unit and each.column in units and si[name] != "1":
            taken = "m/s" if each.radius else si[name]
            notes.append(
                f"{each.column} has no unit, neither in the file nor in the mapping, and is taken"
                f" as {taken}"
            )
    return tuple(notes)
