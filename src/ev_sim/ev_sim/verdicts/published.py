"""The list of what a source published: config/published/SOURCE.csv, one line for each thing that can be judged."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from functools import cache

from ev_msgs_py.parameters.csv_file import find_file

KINDS = ("printed", "follows", "words", "axes", "lost")


@dataclass(frozen=True, slots=True)
class Published:
    """A number, curve or claim of a source.

    `kind`: printed (stands in the source), follows (not printed, but follows from printed equations and parameters
    alone), words (stated in words), axes (the range of an axis is left), lost (a curve of which only the caption is
    left). `where`: equation, axes or panel. `quantity` and `printed` say what was published, in words and numbers.
    """

    id: str
    kind: str
    where: str
    quantity: str
    printed: str


@cache
def published(source: str) -> dict[str, Published]:
    """Everything that a source published by id, in the order of its list; ValueError for a line that is not one."""
    path = find_file(f"published/{source}.csv")
    lines = [line for line in path.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    listed: dict[str, Published] = {}
    for row in csv.reader(lines[1:]):
        entry = Published(*row)
        if entry.kind not in KINDS:
            raise ValueError(f"{path}: {entry.id}: kind {entry.kind!r} is refused, allowed is {', '.join(KINDS)}")
        if entry.id in listed:
            raise ValueError(f"{path}: {entry.id} stands there twice")
        listed[entry.id] = entry
    return listed
