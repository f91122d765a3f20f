"""The sources: what each of them published, as its package lists it, one line for each thing that can be judged."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from ev_core.methods.offered import offered, offered_module
from ev_core.parameters.data_file import TEXT, read_data

GROUP = "ev_stack.sources"  # of entry points: the name of a source, and its module


@cache
def sources() -> dict[str, Any]:
    """The module of each source by name, in their `ORDER`.

    It has DECLARATIONS (how each id is judged) and PANELS (its figures), and published.csv beside it.
    """
    found = {name: source_named(name) for name in offered(GROUP)}
    return dict(sorted(found.items(), key=lambda each: (each[1].ORDER, each[0])))


def source_named(name: str) -> Any:
    """The module of a source, and of no other; ParameterError that lists the known ones if there is none."""
    return offered_module(GROUP, "source", name)


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
    path = Path(find_spec(offered(GROUP)[source]).origin).with_name(
        "published.csv"
    )  # without the module, which reads it
    text = read_data(path, TEXT).decode()
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    listed: dict[str, Published] = {}
    for row in csv.reader(lines[1:]):
        entry = Published(*row)
        if entry.kind not in KINDS:
            raise ValueError(f"{path}: {entry.id}: kind {entry.kind!r} is refused, allowed is {', '.join(KINDS)}")
        if entry.id in listed:
            raise ValueError(f"{path}: {entry.id} stands there twice")
        listed[entry.id] = entry
    return listed
