"""The files of a module and of all modules that it imports, wherever in their texts they do."""

from __future__ import annotations

import ast
import sys
from collections.abc import Collection, Iterator
from importlib.util import find_spec, resolve_name
from pathlib import Path

_INSTALLED = frozenset(("site-packages", "dist-packages"))


def imported_files(module: str, but: Collection[str]) -> list[Path]:
    """Those of a module by its name, apart from Python's own and those of some packages; libraries in C as well.

    What somebody else's installed package imports in its turn is left out.
    """
    found: dict[str, Path] = {}
    waiting, own = [module], module.partition(".")[0]
    for name in waiting:
        top = name.partition(".")[0]
        file = None if name in found or top in but or top in sys.stdlib_module_names else _file(name)
        if file is not None:
            found[name] = file
            waiting += _imports(name, file) if top == own or not _INSTALLED.intersection(file.parts) else ()
    return list(dict.fromkeys(found.values()))


def _file(module: str) -> Path | None:
    try:
        spec = find_spec(module)
    except (ImportError, AttributeError, ValueError):  # a name in a module, no module; or none of this machine
        return None
    return Path(spec.origin) if spec is not None and spec.has_location and spec.origin else None


def _imports(module: str, file: Path) -> Iterator[str]:
    """The modules that a text may mean; a name that is imported from a package may be one, too."""
    if file.suffix != ".py":
        return
    package = module if file.name == "__init__.py" else module.rpartition(".")[0]
    for node in ast.walk(ast.parse(file.read_bytes())):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = resolve_name("." * node.level + (node.module or ""), package)
            names = [base, *(f"{base}.{alias.name}" for alias in node.names)]
        else:
            continue
        for name in names:
            parts = name.split(".")
            yield from (".".join(parts[: n + 1]) for n in range(len(parts)))
