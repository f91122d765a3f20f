"""Comparisons with measured data: each declared with limit and reason, driven from a folder of the user's files.

`config/measured/comparisons.csv` has a line for each: id, the file of data, what is compared, unit,
largest number that holds, why that, and a command that gives it.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ev_core.parameters.data_file import TEXT, find_in_config, read_data
from ev_msgs_py.refusal import ParameterError
from ev_stack.report.tables import text_table
from ev_study.measured.comparisons.planar_mechanics import planar_mechanics
from ev_study.measured.comparisons.records import electric_cars, motor_map, track_record, tyre_rig

# By file of data, what takes the folder and gives numbers by id.
_DRIVERS: Mapping[str, Callable[[Path], Mapping[str, float]]] = {
    "ferrari_250lm_1.csv.xz": track_record,
    "tyre_rig_cornering.csv.xz": tyre_rig,
    "epa_2022_electric_cars.csv": electric_cars,
    "id3_motor_map.csv": motor_map,
    "planar_mechanics": planar_mechanics,
}
COLUMNS = ("what", "number", "holds", "verdict", "why this limit", "command")
FILE = "comparisons.csv"  # id and value of what was driven


@dataclass(frozen=True)
class Comparison:
    """A number that is compared: its `unit`, the largest that holds (`most`), and why that."""

    id: str
    data: str
    what: str
    unit: str
    most: float
    reason: str
    command: str

    def row(self, value: float) -> tuple[str, ...]:
        """Cells of a table, by `COLUMNS`."""
        number = f"{value:.3g} {self.unit}".removesuffix(" 1")
        verdict = "holds" if value <= self.most else "does not hold"
        return (
            self.what,
            number,
            f"at most {self.most:g}",
            verdict,
            self.reason,
            f"`{self.command}`",
        )


def declared() -> list[Comparison]:
    """All comparisons, in the order of their file."""
    file = find_in_config("measured/comparisons.csv")
    if file is None:
        raise ParameterError("measured/comparisons.csv is in no config folder")
    lines = csv.DictReader(io.StringIO(read_data(file, TEXT).decode(), newline=""))
    return [Comparison(**{**line, "most": float(line["most"])}) for line in lines]


def compare(folder: Path, progress: Callable[[str], None] = lambda line: None) -> dict[str, float]:
    """The numbers by id of all comparisons with data in a folder; ParameterError without any."""
    # A user may have only some of the files.
    there = [name for name in _DRIVERS if (folder / name).exists()]
    if not there:
        raise ParameterError(
            f"{folder} has no measured data, expected a folder with {', '.join(_DRIVERS)}"
        )
    found: dict[str, float] = {}
    for name in there:
        progress(f"{name} ...")
        found |= _DRIVERS[name](folder)
    return found


def kept_text(found: Mapping[str, float]) -> str:
    """The text of `FILE`, in the order in which they are declared."""
    return "id,value\n" + "".join(
        f"{each.id},{found[each.id]:.5g}\n" for each in declared() if each.id in found
    )


def rows(found: Mapping[str, float]) -> Sequence[tuple[str, ...]]:
    """Those that were driven, by `COLUMNS`."""
    return [each.row(found[each.id]) for each in declared() if each.id in found]


def table(found: Mapping[str, float]) -> str:
    """Table for the terminal."""
    return text_table(COLUMNS[:4], [row[:4] for row in rows(found)], left=COLUMNS[:4])
