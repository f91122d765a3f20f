"""Parameter dataclasses as numpy records, so that compiled code reads a parameter by its name."""

from __future__ import annotations

from typing import Any

import numpy as np

from ev_msgs_py.parameters import entries


def record_of(parameters: Any) -> np.ndarray:
    """The numbers of a parameter dataclass as an array of shape (1,) whose record has the same names.

    A group becomes a nested record, a switch 0 or 1, a text with choices the index of its choice. Free text and
    arrays, which no record can hold, are left out.
    """
    columns = _columns(parameters)
    record = np.zeros(1, _dtype(columns))
    record[0] = _values(columns)
    return record


def _columns(parameters: Any) -> dict[str, Any]:
    """Names and values of a parameter dataclass, as a tree of dictionaries whose leaves are float or int."""
    columns: dict[str, Any] = {}
    for entry in entries(parameters):
        group_name, _, nested = entry.name.partition(".")
        if nested:
            columns.setdefault(group_name, _columns(getattr(parameters, group_name)))
        elif entry.spec.choices and not entry.is_array:
            columns[entry.name] = entry.spec.choices.index(entry.default)
        elif entry.type is not str and not entry.is_array:
            columns[entry.name] = entry.type(entry.default)
    return columns


def _dtype(columns: dict[str, Any]) -> np.dtype:
    """The aligned record type of a tree of columns; whole numbers and switches take eight bytes like the rest."""
    return np.dtype([(name, _column_type(value)) for name, value in columns.items()], align=True)


def _column_type(value: Any) -> np.dtype:
    if isinstance(value, dict):
        return _dtype(value)
    return np.dtype(np.float64 if isinstance(value, float) else np.int64)


def _values(columns: dict[str, Any]) -> tuple[Any, ...]:
    return tuple(_values(value) if isinstance(value, dict) else value for value in columns.values())
