"""What the result of a case depends on, as digests: earlier results are taken again while nothing of it changes."""

from __future__ import annotations

import ast
import hashlib
import sys
from collections.abc import Collection, Iterable, Iterator, Sequence
from functools import cache
from importlib import import_module
from importlib.util import find_spec, resolve_name
from pathlib import Path

from ev_core.methods.register import Method
from ev_core.parameters.data_file import config_folders, files_read
from ev_sim.report.summary import PACKAGES, versions
from ev_sim.study.case import Case, run_of

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


NEVER_DRIVES = ("ev_sim/commands", "ev_sim/dashboard", "ev_sim/report/page")
_OURS = ("ev_msgs_py", "ev_core", "ev_control", "ev_sim", "ev_papers")
_LENGTH = 24  # hexadecimal digits


def case_key(case: Case) -> str:
    """A digest of what a case says, whatever its name."""
    said = (case.scenario, case.values, case.run, [str(file) for file in case.files], case.duration, case.vehicle)
    return _short(repr(said))


def row_key(study: str, case: Case) -> str:
    """A digest of all that what a study measures on a case depends on, but for `digest_of_sources`.

    It is of the run with all its values, the names and texts of the files that were read for it, and the texts of the
    methods that are not ours. ParameterError if the case is refused, ValueError if a law refuses its vehicle.
    """
    with files_read() as files:
        run = run_of(case)
        for configuration in run.configurations.values():
            configuration.create()
    roles = {role: (_text_of(each.method), each.values()) for role, each in run.configurations.items()}
    read = sorted((Path(name).name, digest) for name, digest in files.items())
    return _short(repr((study, run.name, run.duration, run.report, run.metrics, roles, read)))


def _text_of(method: Method) -> str:
    """A digest of the texts of a method and of what they import; empty if it is ours."""
    return "" if method.package in _OURS else _texts_of(method.documented.__module__)


@cache
def _texts_of(module: str) -> str:
    return _digest("", ((path.name, path) for path in imported_files(module, but=(*_OURS, *PACKAGES))))


def digest_of_sources(without: Sequence[str] = NEVER_DRIVES, config: bool = False) -> str:
    """Of our sources but those below some folders, of versions of packages, and of the config folders if wanted."""
    return _digest(repr(sorted(versions().items())), [*_sources(without), *(_config() if config else ())])


def _short(said: str) -> str:
    return hashlib.sha256(said.encode()).hexdigest()[:_LENGTH]


def _digest(said: str, files: Iterable[tuple[str, Path]]) -> str:
    digest = hashlib.sha256(said.encode())
    for name, path in sorted(files):
        digest.update(f"{name}\0".encode() + path.read_bytes())
    return digest.hexdigest()[:_LENGTH]


def _sources(without: Sequence[str]) -> Iterable[tuple[str, Path]]:
    for package in _OURS:
        top = Path(import_module(package).__file__ or "").parent.parent
        for path in (top / package).rglob("*.py"):
            name = path.relative_to(top).as_posix()
            # What the compiler leaves beside the sources says nothing that they do not.
            if "__pycache__" not in path.parts and not name.startswith(tuple(f"{each}/" for each in without)):
                yield name, path


def _config() -> Iterable[tuple[str, Path]]:
    for config in config_folders():
        for path in config.rglob("*"):
            if path.is_file() and "published" not in path.relative_to(config).parts:
                yield path.relative_to(config).as_posix(), path
