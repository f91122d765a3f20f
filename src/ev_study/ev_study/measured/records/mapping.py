"""Meaning of a record's columns: the mapping file beside it, or a bag's standard messages.

How it works: the mapping file gives the column of each channel, its unit and how the sensor is
mounted. A reader that fits the suffix of the file gives columns with their times, each sensor on a
clock of its own; factors and units are applied here, and `record.measured` brings all to one clock
and one place.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml

from ev_core.parameters.data_file import TEXT, read_data
from ev_core.parameters.values import build
from ev_msgs_py.contract import frame
from ev_msgs_py.refusal import ParameterError, unknown_name
from ev_stack.scenarios.parameter_file import read_yaml
from ev_study.measured.records import bags, can_logs, mdf
from ev_study.measured.records.record import (
    SIDESLIP,
    ColumnParameters,
    MaskParameters,
    MeasuredRecord,
    Read,
    measured,
)
from ev_study.measured.records.samples import Sampled
from ev_study.measured.records.tables import read_columns
from ev_study.measured.records.units import of_header, with_unit, without_unit

# Of a mapping file; any other word is a misspelt one and is refused.
_ENTRIES = ("time", "dbc", "channel", "channels", "mask")
_BAGS = (".mcap", ".db3", ".bag", "")  # the last is a folder
_TABLES = (".csv", ".xz", ".txt", ".tsv")
Reader = Callable[[Path, Sequence[str]], Read]


def read_record(path: Path, mapping: Path) -> MeasuredRecord:
    """The record of a file, by its mapping.

    Raises ParameterError, in one line that names the file, if it is refused.
    """
    given = _given(mapping)
    known = (*frame.channels(), SIDESLIP)
    declared: dict[str, ColumnParameters] = {}
    for name, about in given["channels"].items():
        if name not in known:
            raise ParameterError(f"{mapping}: {unknown_name('channel', name, known)}")
        declared[name] = _declared(mapping, name, about)
    read = _reader(path, mapping, given)(path, [each.column for each in declared.values()])
    found = {}
    for name, each in declared.items():
        if each.column not in read.columns:
            raise ParameterError(
                f"{mapping}: {name}: {unknown_name(f'column of {path}', each.column, read.columns)}"
            )
        declared[name] = _in_unit(mapping, name, each, read.units)
        found[name] = (
            read.columns[each.column].scaled(declared[name].factor(name)),
            declared[name],
        )
    record = measured(str(path), read.digest, found, build(MaskParameters, given.get("mask") or {}))
    return record.noted(read.notes + without_unit(read.units, declared))


def read_standard(bag: Path) -> MeasuredRecord:
    """The record of a bag of standard messages, each sensor at the centre of mass.

    Raises ParameterError if it is refused.
    """
    chosen = bags.standard_channels(bag)
    read = bags.read_columns(bag, [*chosen.values()])
    # In SI at the centre of mass, as the messages are defined.
    found = {name: (read.columns[column], ColumnParameters()) for name, column in chosen.items()}
    notes = tuple(
        f"{name} is {column}, taken as measured at the centre of mass"
        for name, column in chosen.items()
    )
    record = measured(str(bag), read.digest, found, MaskParameters())
    return record.noted(read.notes + notes)


def _given(mapping: Path) -> Mapping[str, Any]:
    try:
        given = read_yaml(read_data(mapping, TEXT).decode())
    except OSError as error:
        raise ParameterError(f"{mapping}: {error.strerror or error}") from None
    except (yaml.YAMLError, UnicodeDecodeError):
        raise ParameterError(f"{mapping} is no YAML text") from None
    if not isinstance(given, dict) or not isinstance(given.get("channels"), dict):
        raise ParameterError(
            f"{mapping}: expected a mapping with channels and, as needed, time, dbc and mask"
        )
    for name in given:
        if name not in _ENTRIES:
            raise ParameterError(f"{mapping}: {unknown_name('entry', name, _ENTRIES)}")
    return given


def _reader(path: Path, mapping: Path, given: Mapping[str, Any]) -> Reader:
    """Choose the reader of a file's columns with their times.

    The time of a CSV file and the DBC are in the mapping.
    """
    suffix = path.suffix.lower()
    # An .mf4 holds either channels in physical units or frames of a bus; only the latter needs a
    # DBC.
    if suffix == mdf.SUFFIX and "dbc" not in given and "time" not in given:
        return mdf.read_columns
    is_log, is_table = suffix in can_logs.SUFFIXES, suffix in _TABLES
    if not (is_log or is_table or suffix in _BAGS):
        known = ", ".join((".csv", ".csv.xz", *can_logs.SUFFIXES, *_BAGS[:-1]))
        raise ParameterError(f"{path}: expected a file ending with {known}, or the folder of a bag")
    for name, needed, has_use in (
        ("time", is_table, is_table),
        ("dbc", is_log, is_log),
        ("channel", False, is_log),
    ):
        if (needed and name not in given) or (name in given and not has_use):
            use = "needs" if needed else "has no use for"
            raise ParameterError(
                f"{mapping}: {path.name} {use} {name}: time is that of CSV files, dbc and channel"
                " those of CAN logs"
            )
    if is_log:
        # Beside the mapping, so that both can be moved together.
        database = mapping.parent / str(given["dbc"])
        return lambda file, wanted: can_logs.read_columns(
            file, database, wanted, str(given.get("channel", ""))
        )
    if not is_table:
        return bags.read_columns

    def table(file: Path, wanted: Sequence[str]) -> Read:
        found = read_columns(file)
        declared = _declared(mapping, "time", given["time"])
        if declared.column not in found.columns:
            raise ParameterError(
                f"{mapping}: time:"
                f" {unknown_name(f'column of {file}', declared.column, found.columns)}"
            )
        if declared.column in found.texts:
            raise ParameterError(
                f"{file}: {declared.column}: {found.texts[declared.column]}, expected a number for"
                " the time"
            )
        # A row of units goes before brackets in the names.
        units = found.units or of_header(found.columns)
        factor = _in_unit(mapping, "time", declared, units).factor("time")
        time = found.columns[declared.column] * factor
        # All columns of a table share one clock.
        columns = {name: Sampled(time, values) for name, values in found.columns.items()}
        notes = tuple(
            f"{name}: {what}, passed over" for name, what in found.texts.items() if name in wanted
        )
        return Read(columns, found.digest, units, notes)

    return table


def _in_unit(
    mapping: Path, name: str, declared: ColumnParameters, units: Mapping[str, str]
) -> ColumnParameters:
    try:
        return with_unit(name, declared, units.get(declared.column, ""))
    except ParameterError as error:
        raise ParameterError(f"{mapping}: {name}: {error}") from None


def _declared(mapping: Path, name: str, about: Any) -> ColumnParameters:
    try:
        return build(ColumnParameters, {"column": about} if isinstance(about, str) else about)
    except (ParameterError, AttributeError, TypeError) as error:
        raise ParameterError(f"{mapping}: {name}: {error}") from None
