"""The identified car as files: a vehicle file with what is known of each number, and the parameters beside the car.

How it works: the file of the start is written once more, in its own order, with the free numbers
replaced. What is known of each number stands behind it as a comment. An array with several free
elements gets its comments above the line.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import yaml

from ev_core.parameters.declaration import flatten
from ev_core.vehicle.description import Vehicle
from ev_study.measured.free_parameters import FreeParameter


def vehicle_text(
    stated: Mapping[str, Any],
    vehicle: Vehicle,
    free: Sequence[FreeParameter],
    values: np.ndarray,
    notes: Sequence[str],
    head: Sequence[str],
) -> str:
    """A vehicle file: what the start `stated` by dotted name, with the free values of the `vehicle` as files gave it.

    `notes` stand behind the free values, `head` at the top, as comments.
    """
    found = {name: value for name, value in stated.items() if name.startswith("vehicle.")}
    given, comments = flatten(vehicle, "vehicle."), dict[str, list[str]]()
    for each, value, note in zip(free, values, notes, strict=True):
        if not each.is_of_vehicle:
            continue
        if each.place >= 0:
            # The start may name a property file of the tyre in the place of numbers. Its numbers
            # are written out here, and its name goes: else it would replace them when the car is
            # read.
            if each.array not in found or not found[each.array]:
                found[each.array] = given[each.array]
                found.pop(each.array.removesuffix("_mf") + "_file", None)
            found[each.array] = [*found[each.array]]
            found[each.array][each.place] = float(value)
            note = f"{each.name.rpartition('.')[2]} {value:.6g}: {note}"
        else:
            found[each.array] = float(value)
        comments.setdefault(each.array, []).append(note)
    lines = [f"# {line}" for line in head]
    return "\n".join([*lines, "/**:", "  ros__parameters:", *_nested(found, comments)]) + "\n"


def parameter_text(
    beside: Mapping[str, Any],
    free: Sequence[FreeParameter],
    values: np.ndarray,
    notes: Sequence[str],
    head: Sequence[str],
) -> str:
    """A ROS parameter file beside the vehicle's: what was given `beside` it by ROLE.PARAMETER, and the free values."""
    found = {name: (value, "") for name, value in beside.items()}
    found |= {
        f.name: (float(v), n)
        for f, v, n in zip(free, values, notes, strict=True)
        if not f.is_of_vehicle
    }
    lines, last = [f"# {line}" for line in head], ""
    for name in sorted(found):
        role, _, parameter = name.partition(".")
        if role != last:
            lines += [f"/**/{role}:", "  ros__parameters:"]
        value, note = found[name]
        lines.append(f"    {parameter}: {_flow(value)}" + (f"  # {note}" if note else ""))
        last = role
    return "\n".join(lines) + "\n" if found else ""


def _flow(value: Any) -> str:
    """A value in one line of YAML."""
    # One line: YAML would fold long arrays at 80 columns.
    text = yaml.safe_dump(
        [*value] if isinstance(value, tuple) else value, default_flow_style=True, width=10**6
    )
    # A number or text alone ends with the mark of a document's end.
    return text.removesuffix("...\n").strip()


def _nested(values: Mapping[str, Any], comments: Mapping[str, Sequence[str]]) -> Iterator[str]:
    """Lines of YAML, a level of indentation for each dot.

    Comments stand above what has several, else behind.
    """
    before: list[str] = []
    for name in sorted(values, key=_order(values)):
        *groups, last = name.split(".")
        # Groups that the line before has opened already need no line again.
        common = next(
            (n for n, (a, b) in enumerate(zip(before, groups, strict=False)) if a != b),
            min(len(before), len(groups)),
        )
        for level in range(common, len(groups)):
            yield f"{'  ' * (level + 2)}{groups[level]}:"
        before = groups
        indent = "  " * (len(groups) + 2)
        about = comments.get(name, ())
        if len(about) > 1:
            yield from (f"{indent}# {line}" for line in about)
        text = _flow(values[name])
        yield f"{indent}{last}: {text}" + (f"  # {about[0]}" if len(about) == 1 else "")


def _order(values: Mapping[str, Any]) -> Any:
    """Keep the stated order, but put single values of a group first, so that each group is one."""
    places = {name: n for n, name in enumerate(values)}
    first: dict[str, int] = {}
    for name, place in places.items():
        parts = name.split(".")
        for n in range(1, len(parts)):
            first.setdefault(".".join(parts[:n]), place)

    def key(name: str) -> list[tuple[int, int]]:
        parts = name.split(".")
        return [(1, first[".".join(parts[:n])]) for n in range(1, len(parts))] + [(0, places[name])]

    return key
