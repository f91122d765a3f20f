"""Digest of the sources on which the numbers of a run depend beside its values and files.

Those of ours are one digest for all that is driven. Those of a user's methods, reports and
studies count where they are used, so that an edit of one law leaves the rows of the others. The
data files of their packages, such as published.csv, count with them; those in their config folders
are read, and counted, with what is driven.

How it works: three digests are made. That of our sources names the folder of a store
(`digest_of_sources`); those of a user's methods, reports and studies go into the key of each row.
Imports are followed through the text of the modules, without importing them, as far as the user's
own code goes.
"""

from __future__ import annotations

import ast
import hashlib
import sys
from collections.abc import Collection, Iterable, Iterator, Sequence
from functools import cache
from importlib import import_module
from importlib.util import find_spec, resolve_name
from pathlib import Path

from ev_core.methods.method_record import Method
from ev_core.methods.offered import offered
from ev_core.parameters.data_file import config_folders, entry_points
from ev_msgs_py.packages import OURS
from ev_stack.command_line.offered_commands import STUDIES
from ev_stack.report.summary import PACKAGES, versions
from ev_stack.scenarios.about import REPORTS

SOURCES = "ev_stack.sources"  # of entry points; reports may measure by their published.csv
_GROUPS = (STUDIES, REPORTS, SOURCES, "ev_stack.methods")
_INSTALLED = frozenset(("site-packages", "dist-packages"))
# Code that changes no number of a run: an edit of it leaves what was driven.
NEVER_DRIVES = ("ev_stack/commands", "ev_study/commands", "ev_doors", "ev_stack/report/page")
# 96 bits: no two contents of a store will ever have one digest by chance.
_LENGTH = 24  # hexadecimal digits


def digest_of(file: Path) -> str:
    """SHA-256 of a file, as hexadecimal digits."""
    with file.open("rb") as content:
        return hashlib.file_digest(content, "sha256").hexdigest()


def imported_files(module: str, but: Collection[str]) -> list[Path]:
    """Those of a module by its name, apart from Python's own and those of some packages.

    Libraries in C as well.

    The imports of other installed packages are left out.
    """
    found: dict[str, Path] = {}
    waiting, own = [module], module.partition(".")[0]
    for name in waiting:
        # `waiting` grows while it is walked: each module adds those that it imports.
        top = name.partition(".")[0]
        file = (
            None if name in found or top in but or top in sys.stdlib_module_names else _file(name)
        )
        if file is not None:
            found[name] = file
            waiting += (
                _imports(name, file)
                if top == own or not _INSTALLED.intersection(file.parts)
                else ()
            )
    return list(dict.fromkeys(found.values()))


def _file(module: str) -> Path | None:
    try:
        spec = find_spec(module)
    # a name in a module, no module; or none of this machine
    except (ImportError, AttributeError, ValueError):
        return None
    return Path(spec.origin) if spec is not None and spec.has_location and spec.origin else None


def _imports(module: str, file: Path) -> Iterator[str]:
    """The modules that a text may mean; a name that is imported from a package may be one, too."""
    package = module if file.name == "__init__.py" else module.rpartition(".")[0]
    try:
        tree = ast.parse(file.read_bytes() if file.suffix == ".py" else "")
    # what is imported where it can be, such as of another Python: its text counts
    except (SyntaxError, ValueError):
        return
    for node in ast.walk(tree):
        if isinstance(node, ast.Import | ast.ImportFrom):
            names = [alias.name for alias in node.names]
            # `from a import b` may mean the module a.b or a name in a: both are tried.
            if isinstance(node, ast.ImportFrom):
                base = resolve_name("." * node.level + (node.module or ""), package)
                names = [base, *(f"{base}.{name}" for name in names)]
            for name in names:
                parts = name.split(".")
                # A package is executed on the way to its modules, so its __init__ counts, too.
                yield from (".".join(parts[: n + 1]) for n in range(len(parts)))


def text_of_method(method: Method) -> str:
    """A digest of the texts of a method and of what they import; empty if it is ours."""
    return _texts_of(method.documented.__module__)


def text_of_study(name: str) -> str:
    """The same of a study, and of a name that is none."""
    return _texts_of(offered(STUDIES).get(name, ""))


def text_of_report(name: str) -> str:
    """Text of a report and of published numbers: of ours, or of any for a user's report."""
    module, sources = offered(REPORTS).get(name, ""), sorted(offered(SOURCES).values())
    if not module:
        return ""
    # One of ours measures by our published numbers alone.
    own = _texts_of(module)
    return short_digest((own, _published(), [_texts_of(each) for each in sources] if own else []))


@cache
def _texts_of(module: str) -> str:
    """A digest of a user's module, of what it imports, and of the data files of its package."""
    if module.partition(".")[0] in ("", *OURS):
        return ""
    files = {(path.name, path) for path in imported_files(module, but=(*OURS, *PACKAGES))}
    return _digest("", {*files, *_data_of(module.partition(".")[0])})


def _data_of(package: str) -> Iterator[tuple[str, Path]]:
    """The files of a package that are no code, but for its config folder, by their names below it."""
    file = _file(package)
    if file is None or file.name != "__init__.py":  # a module alone may have any neighbours
        return
    for path in file.parent.rglob("*"):
        name = path.relative_to(file.parent)
        is_code = path.suffix == ".py" or "__pycache__" in name.parts
        # Code is found by its imports, config by what is read of it.
        if path.is_file() and not is_code and name.parts[0] != "config":
            yield f"{package}/{name.as_posix()}", path


@cache
def _published() -> str:
    """A digest of what our sources have published."""
    tops = [Path(import_module(package).__file__ or "").parent for package in OURS]
    return _digest(
        "",
        ((path.relative_to(top).as_posix(), path) for top in tops for path in top.rglob("*.csv")),
    )


def digest_of_sources(
    without: Sequence[str] = NEVER_DRIVES, config: bool = False, others: bool = False
) -> str:
    """The digest of our sources but for some folders, and of package versions.

    Of the config folders as well if wanted, and of all `others` that are installed for us.
    """
    modules = (
        sorted({point.value for group in _GROUPS for point in entry_points(group=group)})
        if others
        else ()
    )
    head = sorted(versions().items()), [_texts_of(each) for each in modules]
    return _digest(repr(head), [*_sources(without), *(_config() if config else ())])


def config_files() -> dict[str, str]:
    """SHA-256, by path, of each file in the config folders."""
    return {str(path): digest_of(path) for _, path in _config()}


def short_digest(content: object) -> str:
    """Some digits that change with what is written of a content."""
    return hashlib.sha256(repr(content).encode()).hexdigest()[:_LENGTH]


def _digest(head: str, files: Iterable[tuple[str, Path]]) -> str:
    digest = hashlib.sha256(head.encode())
    for name, path in sorted(files):
        # The name counts as well: texts that change places are another content.
        digest.update(f"{name}\0".encode() + path.read_bytes())
    return digest.hexdigest()[:_LENGTH]


def _sources(without: Sequence[str]) -> Iterable[tuple[str, Path]]:
    for package in OURS:
        top = Path(import_module(package).__file__ or "").parent.parent
        for path in (top / package).rglob("*.py"):
            name = path.relative_to(top).as_posix()
            # What the compiler leaves beside the sources follows from them.
            if "__pycache__" not in path.parts and not name.startswith(
                tuple(f"{each}/" for each in without)
            ):
                yield name, path


def _config() -> Iterable[tuple[str, Path]]:
    for config in config_folders():
        for path in config.rglob("*"):
            if path.is_file() and "published" not in path.relative_to(config).parts:
                yield path.relative_to(config).as_posix(), path
