"""An export as a Functional Mock-up Unit: libraries for several systems in one file."""

from __future__ import annotations

import math
import re
import tempfile
import zipfile
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

from ev_core.parameters.declaration import entries
from ev_doors.export.content import Content
from ev_doors.export.library import Library, low_of
from ev_doors.export.targets import Target
from ev_msgs_py.refusal import ParameterError, unknown_name
from ev_stack.recording.recording import atomic_file
from ev_stack.running.output_folder import new_file

VERSIONS = (2, 3)
# C23, in which parameters need no names: FMI has many functions that use none of theirs.
_OPTIONS = (
    "-std=gnu2x",
    "-O2",
    "-ffp-contract=off",
    "-fPIC",
    "-fvisibility=hidden",
    "-shared",
    "-s",
)
# No build id and no time stamp, so that the same export is the same file.
_OPTIONS_OF = {
    "Linux": ("-Wl,-Bsymbolic,--build-id=none",),
    "Windows": ("-static-libgcc", "-Wl,--no-insert-timestamp"),
}
# Where a library stands in an FMU of FMI 2 and 3. FMI 2 has no name for 64-bit Arm.
_PLACES = {
    "x86_64-linux": ("linux64/{}.so", "x86_64-linux/{}.so"),
    "aarch64-linux": ("aarch64-linux/{}.so", "aarch64-linux/{}.so"),
    "x86_64-windows": ("win64/{}.dll", "x86_64-windows/{}.dll"),
}
TARGETS = (*_PLACES,)
_NO_DATE = (1980, 1, 1, 0, 0, 0)  # so that the same export is the same file

_MECHANICAL = {
    "m": {"m": 1},
    "s": {"s": 1},
    "kg": {"kg": 1},
    "rad": {"rad": 1},
    "A": {"A": 1},
    "K": {"K": 1},
    "1": {},
}
_SYMBOLS = {
    **_MECHANICAL,
    "N": {"kg": 1, "m": 1, "s": -2},
    "J": {"kg": 1, "m": 2, "s": -2},
    "W": {"kg": 1, "m": 2, "s": -3},
    "V": {"kg": 1, "m": 2, "s": -3, "A": -1},
    "ohm": {"kg": 1, "m": 2, "s": -3, "A": -2},
    "H": {"kg": 1, "m": 2, "s": -2, "A": -2},
    "Wb": {"kg": 1, "m": 2, "s": -2, "A": -1},
    "F": {"kg": -1, "m": -2, "s": 4, "A": 2},
    "Hz": {"s": -1},
}
_NOT_COHERENT: dict[str, dict[str, float]] = {
    "degC": {"K": 1, "offset": 273.15},
    "A h": {"A": 1, "s": 1, "factor": 3600.0},
    "l/min": {"m": 3, "s": -1, "factor": 1e-3 / 60.0},
}


class Variable(NamedTuple):
    """A number as FMI describes it."""

    attributes: dict[str, Any]
    of_value: dict[str, Any]


def write_fmu(content: Content, fmi: int, targets: Sequence[Target], file: Path) -> None:
    """Write an FMU of FMI 2 or 3 to a new file; its model is named after the file.

    ParameterError, in one line, for another name and a target that has no FMUs.
    """
    if file.suffix != ".fmu":
        raise ParameterError(f"{file} is refused, expected NAME.fmu")
    for target in targets:
        if target.name not in _PLACES:
            raise unknown_name("target of an FMU", target.name, _PLACES)
    library = Library(content, file.stem)
    with tempfile.TemporaryDirectory() as made:
        packed = {
            place(file.stem, fmi, each.name): _binary(library, fmi, each, Path(made))
            for each in targets
        }
        packed = {
            "modelDescription.xml": _description(library, fmi, targets[0], Path(made)),
            **packed,
        }
        with atomic_file(new_file(file)) as written, zipfile.ZipFile(written, "w") as archive:
            for name, path in packed.items():
                entry = zipfile.ZipInfo(name, _NO_DATE)
                # Unix permissions, without which some tools unpack files that cannot be read.
                entry.external_attr = 0o644 << 16
                archive.writestr(entry, path.read_bytes(), zipfile.ZIP_DEFLATED)


def place(name: str, fmi: int, target: str) -> str:
    """Path of the library for a target in an FMU of a name."""
    return f"binaries/{_PLACES[target][VERSIONS.index(fmi)].format(name)}"


def _binary(library: Library, fmi: int, target: Target, folder: Path) -> Path:
    """The shared library for a target, in a folder of its own."""
    folder /= target.name
    folder.mkdir()
    objects = library.objects(target, folder)
    templates = ["model.h", "constants.h", "fmu.h", "model.c", f"fmi{fmi}.c"]
    sources = library.write(folder, target, templates, token=_token(library))
    made = folder / Path(place(library.given_name, fmi, target.name)).name
    return target.program([*objects, *sources[3:]], made, (*_OPTIONS, *_OPTIONS_OF[target.system]))


def _token(library: Library) -> str:
    """Identifier, in the form of a GUID, that binds the description to the library."""
    digest = library.content.digest
    return (
        f"{{{'-'.join(digest[a:b] for a, b in ((0, 8), (8, 12), (12, 16), (16, 20), (20, 32)))}}}"
    )


def _description(library: Library, fmi: int, target: Target, folder: Path) -> Path:
    """modelDescription.xml."""
    content, variables = library.content, _variables(library)
    # Behind time and inputs, as fmu.h counts the references.
    first = 1 + len(content.inputs)
    (made,) = library.write(
        folder,
        target,
        ["modelDescription.xml"],
        fmi=fmi,
        token=_token(library),
        version=version("ev_stack"),
        period=content.period / 1e9,
        units={each.of_value["unit"]: base_unit(each.of_value["unit"]) for each in variables},
        variables=variables,
        output_references=range(first, first + len(content.outputs)),
    )
    return made


def _variables(library: Library) -> list[Variable]:
    """Time, inputs, outputs and parameters, in the order of their references."""
    content = library.content
    tunables = [
        (each, part.constants[each.place]) for part in content.parts for each in part.tunables
    ]
    about = {
        f"{role}.{entry.name}": entry.spec.about
        for role in content.roles
        for entry in entries(content.run.configurations[role].given)
    }
    found: list[Variable] = []

    def add(name: str, unit: str, how: str, limits: Mapping[str, float]) -> None:
        causality, variability, initial = how.split()
        # The place in this list is the reference: fmu.h finds each number by its order alone.
        attributes = {
            "name": name,
            "valueReference": len(found),
            "causality": causality,
            "variability": variability,
        }
        # FMI does not allow `initial` of an input or of the independent variable.
        attributes |= {} if initial == "none" else {"initial": initial}
        attributes |= {"description": about[name]} if name in about else {}
        # XML of FMI has no infinity: a limit that is none is left out.
        finite = {name: value for name, value in limits.items() if math.isfinite(value)}
        found.append(Variable(attributes, {"unit": unit or "1", **finite}))

    add("time", "s", "independent continuous none", {})
    for each in content.inputs:
        add(each.name, each.unit, "input discrete none", {"min": low_of(each), "start": 0.0})
    for each in content.outputs:
        add(each.name, each.unit, "output discrete calculated", {})
    for each, start in tunables:
        add(
            each.name,
            each.unit,
            "parameter tunable exact",
            {"min": each.low, "max": each.high, "start": start},
        )
    return found


def base_unit(unit: str) -> dict[str, float] | None:
    """The exponents of a unit in SI, with factor and offset; None for one that has none."""
    if unit in _NOT_COHERENT:
        return _NOT_COHERENT[unit]
    exponents: dict[str, float] = {}
    above, _, below = unit.partition("/")
    for sign, part in ((1, above), (-1, below)):
        inner, power = re.fullmatch(r"\(?([^()]*)\)?(?:(?<=\))\^(\d))?", part).groups()
        for word in inner.split():
            symbol, _, own = word.partition("^")
            if symbol not in _SYMBOLS:
                return None
            for base, exponent in _SYMBOLS[symbol].items():
                # The power of the parentheses counts for each unit within, as in 1/(s rad)^2.
                by = sign * int(power or 1) * int(own or 1)
                exponents[base] = exponents.get(base, 0) + by * exponent
    # What cancels out is not listed.
    return {base: exponent for base, exponent in exponents.items() if exponent}
