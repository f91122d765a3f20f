"""What the columns of a record are: the mapping file beside it, or the standard messages of a bag."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml

from ev_core.parameters.data_file import TEXT, read_data
from ev_core.parameters.values import build
from ev_msgs_py.contract import frame
from ev_msgs_py.refusal import ParameterError, unknown_name
from ev_sim.measured.records import bags, can_logs, mdf
from ev_sim.measured.records.record import (
    SIDESLIP,
    ColumnParameters,
    MaskParameters,
    MeasuredRecord,
    Sampled,
    measured,
)
from ev_sim.measured.records.tables import read_columns
from ev_sim.scenarios.parameter_file import read_yaml

_ENTRIES = ("time", "dbc", "channels", "mask")
_BAGS = (".mcap", ".db3", "")  # the last is a folder
Reader = Callable[[Path, Sequence[str]], tuple[dict[str, Sampled], str]]


def read_record(path: Path, mapping: Path) -> MeasuredRecord:
    """The record of a file, by its mapping; ParameterError, in one line that names the file, if it is refused."""
    given = _given(mapping)
    known = (*frame.channels(), SIDESLIP)
    declared: dict[str, ColumnParameters] = {}
    for name, about in given["channels"].items():
        if name not in known:
            raise ParameterError(f"{mapping}: {unknown_name('channel', name, known)}")
        declared[name] = _declared(mapping, name, about)
    columns, digest = _reader(path, mapping, given)(path, [each.column for each in declared.values()])
    found = {}
    for name, each in declared.items():
        if each.column not in columns:
            raise ParameterError(f"{mapping}: {name}: {unknown_name(f'column of {path}', each.column, columns)}")
        found[name] = (columns[each.column].scaled(each.factor(name)), each)
    return measured(str(path), digest, found, build(MaskParameters, given.get("mask") or {}))


def read_standard(bag: Path) -> MeasuredRecord:
    """The record of a bag of standard messages, each sensor at the centre of mass; ParameterError if it is refused."""
    chosen = bags.standard_channels(bag)
    columns, digest = bags.read_columns(bag, [*chosen.values()])
    found = {name: (columns[column], ColumnParameters()) for name, column in chosen.items()}
    notes = tuple(f"{name} is {column}, taken as measured at the centre of mass" for name, column in chosen.items())
    record = measured(str(bag), digest, found, MaskParameters())
    return record.noted(notes)


def _given(mapping: Path) -> Mapping[str, Any]:
    try:
        given = read_yaml(read_data(mapping, TEXT).decode())
    except OSError as error:
        raise ParameterError(f"{mapping}: {error.strerror or error}") from None
    except (yaml.YAMLError, UnicodeDecodeError):
        raise ParameterError(f"{mapping} is no YAML text") from None
    if not isinstance(given, dict) or not isinstance(given.get("channels"), dict):
        raise ParameterError(f"{mapping}: allowed is a mapping with channels and, as needed, time, dbc and mask")
    for name in given:
        if name not in _ENTRIES:
            raise ParameterError(f"{mapping}: {unknown_name('entry', name, _ENTRIES)}")
    return given


def _reader(path: Path, mapping: Path, given: Mapping[str, Any]) -> Reader:
    """What reads the columns of a file with their times; the time of a CSV file and the DBC are in the mapping."""
    if path.suffix == mdf.SUFFIX and "dbc" not in given and "time" not in given:
        return mdf.read_columns
    is_log = path.suffix in can_logs.SUFFIXES
    is_table = not is_log and path.suffix not in _BAGS
    for name, needed in (("time", is_table), ("dbc", is_log)):
        if (name in given) != needed:
            use = "needs" if needed else "has no use for"
            raise ParameterError(
                f"{mapping}: {path.name} {use} {name}: time is that of CSV files, dbc that of CAN logs"
            )
    if is_log:
        database = mapping.parent / str(given["dbc"])
        return lambda file, wanted: can_logs.read_columns(file, database, wanted)
    if not is_table:
        return bags.read_columns

    def table(file: Path, wanted: Sequence[str]) -> tuple[dict[str, Sampled], str]:
        columns, digest = read_columns(file)
        declared = _declared(mapping, "time", given["time"])
        if declared.column not in columns:
            raise ParameterError(f"{mapping}: time: {unknown_name(f'column of {file}', declared.column, columns)}")
        time = columns[declared.column] * declared.factor("time")
        return {name: Sampled(time, values) for name, values in columns.items()}, digest

    return table


def _declared(mapping: Path, name: str, about: Any) -> ColumnParameters:
    try:
        return build(ColumnParameters, {"column": about} if isinstance(about, str) else about)
    except (ParameterError, AttributeError, TypeError) as error:
        raise ParameterError(f"{mapping}: {name}: {error}") from None
