"""The map of the house: its packages and rooms by the layers of .importlinter."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from importlib.util import find_spec
from pathlib import Path

import grimp
from importlinter.api import read_configuration

from documentation.markdown import code, codes, table

DECLARATION = Path(__file__).parents[2] / ".importlinter"
_PACKAGES = "packages"  # id of the contract that puts these into layers

# the upper ones first; names without the package that holds them
Layers = tuple[tuple[str, ...], ...]


def package_table() -> str:
    """Every package with what it holds and what it imports, the uppermost first."""
    imported: dict[str, list[str]] = {}
    for importer, below in arrows():
        imported.setdefault(importer, []).append(below)
    names = [name for layer in layers() for name in layer]
    return table(
        ("package", "what it holds", "imports"),
        ((code(name), about(name), codes(imported.get(name, ())) or "-") for name in names),
    )


def room_tables() -> str:
    """Every room with its line, by package and layer, the uppermost first; rooms within a room stand below it."""
    texts = []
    for package in (name for layer in layers() for name in layer):
        rows = []
        for number, layer in enumerate(reversed(layers(package)), 1):
            below = [
                (str(number), code(room.removeprefix(f"{package}.")), about(room))
                for name in layer
                for room in (f"{package}.{name}", *_rooms_within(f"{package}.{name}"))
            ]
            rows = [*below, *rows]
        texts.append(f"### {package}\n\n{table(('layer', 'room', 'what it is for'), rows)}")
    return "\n".join(texts)


def layers(package: str = "") -> Layers:
    """The layers of a package, or those of the packages; all its rooms are one layer where none are declared."""
    for contract in read_configuration(str(DECLARATION))["contracts_options"]:
        if contract.get("containers") == package or (not package and contract["id"] == _PACKAGES):
            return tuple(
                filter(None, (tuple(_there(line, package)) for line in contract["layers"]))
            )
    return (tuple(name.removeprefix(f"{package}.") for name in _rooms_within(package, 1)),)


def _there(line: str, package: str) -> Iterator[str]:
    """The names of a line; one in brackets need not be there."""
    for name in map(str.strip, line.split("|")):
        full = f"{package}.{name}" if package else name
        if not name.startswith("(") or find_spec(full.replace("(", "").rstrip(")")):
            yield name.strip("()")


def _rooms_within(room: str, depth: int = 9) -> list[str]:
    """The folders below a room, with the full names of their modules; those of a single module have none."""
    file = Path(find_spec(room).origin)
    found = sorted(file.parent.rglob("*/__init__.py")) if file.name == "__init__.py" else []
    paths = [path.parent.relative_to(file.parent).parts for path in found]
    return [".".join((room, *parts)) for parts in paths if len(parts) <= depth]


def about(module: str) -> str:
    """The first line of the docstring of a module."""
    text = Path(find_spec(module).origin).read_text(encoding="utf-8")
    return (ast.get_docstring(ast.parse(text)) or "").partition("\n")[0]


def arrows() -> list[tuple[str, str]]:
    """Which package imports which; what follows from two others is left out."""
    packages = [name for layer in layers() for name in layer]
    graph = grimp.build_graph(*packages, cache_dir=None)
    for package in packages:
        graph.squash_module(package)
    imports = {
        name: sorted(graph.find_modules_directly_imported_by(name) & {*packages} - {name})
        for name in packages
    }
    return [
        (package, each)
        for package in packages
        for each in imports[package]
        if not any(each in _reached(other, imports) for other in imports[package])
    ]


def _reached(package: str, imports: Mapping[str, list[str]]) -> set[str]:
    """What a package imports, and what that imports, and so on."""
    found: set[str] = set()
    waiting = list(imports[package])
    while waiting:
        name = waiting.pop()
        if name not in found:
            found.add(name)
            waiting += imports[name]
    return found
