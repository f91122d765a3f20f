"""An export as files: compiled, written as C, and put into a folder of the user's.

How it works: each part is machine code for the processor of the target, made by the compiler of the
laws. The templates give its symbol, constants and states as tables to a loop in C, which the
compiler of the target makes. What both call is held against what a target has before anything is
written.
"""

from __future__ import annotations

import math
import re
import tempfile
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

from jinja2 import Environment, PackageLoader, StrictUndefined

from ev_core.compiling.code_store import key_of
from ev_core.compiling.object_symbols import calls, code_size
from ev_core.compiling.other_processors import object_file
from ev_doors.export.content import Channel, Content, Part, Tunable
from ev_doors.export.targets import Target
from ev_msgs_py.contract.fields import NEGLIGIBLE
from ev_msgs_py.contract.frame import UNSIGNED_COMMANDS
from ev_msgs_py.contract.roles import ROLES, RoleKind
from ev_msgs_py.refusal import ParameterError, quoted
from ev_stack.recording.recording import atomic_file
from ev_stack.running.output_folder import new_or_empty

PROTOCOL = 2  # version of what program.c answers
_PER_LINE = 8  # constants
# of names in C and of files, which could else be words of C, of libraries or of the templates
_PREFIX = "evs_"
_OF_LINKER = "_GLOBAL_OFFSET_TABLE_"  # no function: the linker makes it


class Place(NamedTuple):
    """Place of state and constants of a part in an object; -1 for constants that objects share."""

    part: Part
    state: int
    constants: int


class Entry(NamedTuple):
    """A line of a table in C."""

    name: str
    unit: str
    place: int
    low: float = -math.inf
    high: float = math.inf


class Library:
    """Write the C text of an export under a name with a prefix; ParameterError if C refuses it."""

    def __init__(self, content: Content, name: str) -> None:
        # ASCII: \w would also take letters that C compilers refuse.
        if not re.fullmatch(r"[A-Za-z]\w*", name, re.ASCII):
            raise ParameterError(f"name {quoted(name)} is refused, expected one of a function in C")
        self.content, self.given_name, self.name = content, name, _PREFIX + name
        self.places: list[Place] = []
        state = constants = 0
        for part in content.parts:
            self.places.append(Place(part, state, constants if part.is_changed else -1))
            # One number at least, for C has no arrays of none.
            state += max(len(part.state), 1)
            # Constants that never change are shared by all objects, and count for none of them.
            constants += len(part.constants) * part.is_changed
        self.state_size, self.constants_size = state, constants
        self.codes = {self.symbol(part): part.code for part in content.parts}

    def symbol(self, part: Part) -> str:
        """The name of the function of a part, which changes with its code."""
        return f"{self.name}_{key_of(*part.code)}"

    def sizes(self, objects: Sequence[Path]) -> dict[str, Any]:
        """Values for the templates.

        `sizes` gives for each file its roles, bytes of code, and numbers of constants and states;
        `code` and `constants` are the bytes of all.
        """
        rows = []
        for file in objects:
            parts = [part for part in self.content.parts if self.symbol(part) == file.stem]
            count = sum(len(part.constants) + len(part.state) for part in parts)
            rows.append(
                (", ".join(part.role for part in parts), code_size(file.read_bytes()), count)
            )
        return {
            "sizes": rows,
            "code": sum(row[1] for row in rows),
            "constants": 8 * sum(row[2] for row in rows),
        }

    @property
    def about(self) -> str:
        """Description of the export in some words."""
        kept = ", ".join(self.content.roles)
        is_whole = set(self.content.roles) == {*self.content.run.configurations}
        return (
            f"the whole graph of {self.content.run.name}"
            if is_whole
            else f"{kept} of {self.content.run.name}"
        )

    def objects(self, target: Target, folder: Path) -> list[Path]:
        """Compile the object files of all parts in a folder, except those that exist."""
        made = {symbol: folder / f"{symbol}.o" for symbol in self.codes}
        for symbol, file in made.items():
            if not file.exists():
                file.write_bytes(object_file(self.codes[symbol], symbol, target.processor))
        return [*made.values()]

    def write(
        self, folder: Path, target: Target, templates: Sequence[str], **more: Any
    ) -> list[Path]:
        """Files of these templates in a folder."""
        environment = Environment(
            loader=PackageLoader("ev_doors.export"),
            undefined=StrictUndefined,
            trim_blocks=True,
            lstrip_blocks=True,
        )
        environment.filters.update(rows=_rows, number=_number)
        written = []
        for template in templates:
            text = environment.get_template(template).render({**self._given(target), **more})
            written.append(folder / file_name(template, self.name))
            written[-1].write_text(f"{text.strip()}\n", encoding="utf-8")
        return written

    def _given(self, target: Target) -> dict[str, Any]:
        return {
            "name": self.name,
            "given_name": self.given_name,
            "upper": self.name.upper(),
            "about": self.about,
            "protocol": PROTOCOL,
            "id": f"0x{self.content.digest[:16]}",
            "content": self.content,
            "places": self.places,
            "symbols": [self.symbol(part) for part in self.content.parts],
            "state_size": self.state_size,
            "constants_size": self.constants_size,
            "inputs": [Entry(*each, low=low_of(each)) for each in self.content.inputs],
            "negligible": NEGLIGIBLE,
            "outputs": [Entry(*channel) for channel in self.content.outputs],
            "tunables": self.tunables,
            "seeds": [place.constants + n for place in self.places for n in place.part.seeds],
            "target": target,
        }

    @property
    def tunables(self) -> list[Tunable]:
        """All parameters that may change, with their places in an object."""
        return [
            each._replace(place=place.constants + each.place)
            for place in self.places
            for each in place.part.tunables
        ]


def low_of(channel: Channel) -> float:
    """The least number that an input takes."""
    return 0.0 if channel.place in UNSIGNED_COMMANDS else -math.inf


def file_name(template: str, name: str) -> str:
    """The name of a file that is made of a template."""
    stem, _, ending = template.partition(".")
    return (
        template
        if ending in ("txt", "md")
        else {"model": name}.get(stem, f"{name}_{stem}") + f".{ending}"
    )


def _rows(numbers: Sequence[float]) -> str:
    lines = (numbers[n : n + _PER_LINE] for n in range(0, len(numbers), _PER_LINE))
    return "\n".join(f"    {', '.join(map(_number, line))}," for line in lines)


def _number(value: float) -> str:
    """The shortest text that gives the same float64 in C."""
    return repr(float(value)).replace("inf", "INFINITY").replace("nan", "NAN")


def write_library(content: Content, name: str, target: Target, directory: Path) -> None:
    """Write the library of an export into a new or empty folder.

    ParameterError, and nothing is written, for another folder, for a name that C does not know, or
    for a target that cannot have it.
    """
    library = Library(content, name)
    if target.board:
        for role in content.roles:
            if ROLES[role].kind is not RoleKind.ANSWERS:
                raise ParameterError(
                    f"{role} is refused for target {target.name}, expected roles that answer"
                )
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        objects = library.objects(target, folder)
        sources = library.write(folder, target, ["model.h", "constants.h", "model.c"])
        loop = target.compiled(sources[-1])
        # What the objects define themselves does not have to be anywhere else.
        called = {each for file in (*objects, loop) for each in calls(file.read_bytes())} - {
            *library.codes,
            _OF_LINKER,
        }
        if foreign := sorted(called - target.processor.may_call):
            raise ParameterError(
                f"target {target.name}: the loop calls {', '.join(foreign)}, which is not"
                " everywhere"
            )
        archive = target.archive([*objects, loop], folder / f"lib{library.name}.a")
        more = {
            "version": version("ev_stack"),
            "called": sorted(called) or ["nothing"],
            "methods": [
                f"{role} {content.run.configurations[role].method.name}" for role in content.roles
            ],
            **library.sizes(objects),
        }
        templates = [
            "CMakeLists.txt",
            "README.md",
            "program.c",
            *(["board.c", "board.ld"] if target.board else []),
        ]
        written = [*sources, archive, *library.write(folder, target, templates, **more)]
        # Only now, when everything is made: a refusal leaves no folder behind.
        output = new_or_empty(directory)
        for file in written:
            with atomic_file(output / file.name) as to:
                to.write(file.read_bytes())
