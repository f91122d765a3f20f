"""Tables of numbers in CSV files that parameters name. They are read before anything is made, never in a step."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TypeVar

from ev_msgs_py.parameters.config_folders import find_in_config
from ev_msgs_py.parameters.data_file import TABLE, read_data, refuse_outside
from ev_msgs_py.parameters.declaration import ParameterError

T = TypeVar("T")


def find_file(name: str) -> Path:
    """The file that a parameter names: a relative name counts from the config folders, else from the working directory.

    FileNotFoundError if the name is relative and a config folder that is named is not there; ParameterError if another
    file has named it and it leads further than that file may (`data_file`).
    """
    path = Path(name)
    path = path if path.is_absolute() else find_in_config(name) or path
    refuse_outside(name, path)
    return path


def read_csv(parameter: str, name: str, columns: tuple[Mapping[str, float], ...], make: Callable[..., T]) -> T:
    """What `make` makes of some columns of the CSV file `name`, each a tuple of numbers in SI units.

    `columns`: for each column the names that it may have, with the factor from its unit to SI. The file has a header;
    further columns, empty lines and lines that begin with # are passed over. Raises ParameterError, in one line that
    names `parameter` and file, if the file cannot be read, lacks a column or has it twice, or holds something else than
    finite numbers, and if `make` raises one.
    """
    path: Path | str = name
    try:
        path = find_file(name)
        return make(*_read(path, columns))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        reason = (error.strerror or error) if isinstance(error, OSError) else "no CSV text"
        raise ParameterError(f"{parameter}: {path}: {reason}") from None
    except ParameterError as error:
        raise ParameterError(f"{parameter}: {path}: {error}") from None


def _read(path: Path, columns: tuple[Mapping[str, float], ...]) -> list[tuple[float, ...]]:
    file = io.StringIO(read_data(path, TABLE).decode("utf-8-sig"), newline="")
    lines = csv.reader(("" if line.startswith("#") else line for line in file), skipinitialspace=True)
    rows = [(lines.line_num, row) for row in lines if row]
    header = [cell.strip() for cell in rows[0][1]] if rows else []
    found = [[name for name in names if name in header] for names in columns]
    if any(len(names) != 1 for names in found):
        wanted = [names[0] if len(names) == 1 else f"one of {' and '.join(names)}" for names in map(list, columns)]
        line = rows[0][0] if rows else 1
        raise ParameterError(f"line {line}: no header with the columns {', '.join(wanted[:-1])} and {wanted[-1]}")
    if twice := [name for (name,) in found if header.count(name) > 1]:
        raise ParameterError(f"line {rows[0][0]}: column {twice[0]} stands there twice, allowed is once")
    chosen = [(name, header.index(name), names[name]) for (name,), names in zip(found, columns, strict=True)]
    return [
        tuple(factor * _number(row[place] if place < len(row) else None, name, line) for line, row in rows[1:])
        for name, place, factor in chosen
    ]


def _number(text: str | None, column: str, line: int) -> float:
    try:
        value = float(text or "")
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ParameterError(f"line {line}: {column} is no finite number")
    return value
