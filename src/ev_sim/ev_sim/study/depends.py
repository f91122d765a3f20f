"""What the result of a case depends on, as digests: earlier results are taken again while nothing of it changes."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence
from importlib import import_module
from pathlib import Path

from ev_msgs_py.parameters.config_folders import config_folders
from ev_sim.report.summary import versions
from ev_sim.study.case import Case

NEVER_DRIVES = ("ev_sim/commands", "ev_sim/dashboard", "ev_sim/verdicts", "ev_sim/report/figures", "ev_sim/report/page")
_PACKAGES = ("ev_msgs_py", "ev_control", "ev_sim")
_LENGTH = 24  # hexadecimal digits


def case_key(case: Case) -> str:
    """A digest of what a case drives, whatever its name."""
    said = repr((case.scenario, case.values, case.run, [str(file) for file in case.files], case.duration, case.vehicle))
    return hashlib.sha256(said.encode()).hexdigest()[:_LENGTH]


def digest_of_sources(without: Sequence[str] = NEVER_DRIVES) -> str:
    """Of all sources but those below some folders, of configuration files and versions of packages."""
    return _digest(repr(sorted(versions().items())), _files(without))


def digest_of_files(words: Iterable[object]) -> str:
    """Of the contents of all files among some words, as far as they are paths."""
    paths = {str(word): Path(str(word)) for word in words if isinstance(word, str | Path)}
    return _digest("", ((name, path) for name, path in paths.items() if name and path.is_file()))


def _digest(said: str, files: Iterable[tuple[str, Path]]) -> str:
    digest = hashlib.sha256(said.encode())
    for name, path in sorted(files):
        digest.update(f"{name}\0".encode() + path.read_bytes())
    return digest.hexdigest()[:_LENGTH]


def _files(without: Sequence[str]) -> Iterable[tuple[str, Path]]:
    for package in _PACKAGES:
        top = Path(import_module(package).__file__ or "").parent.parent
        for path in (top / package).rglob("*.py"):
            name = path.relative_to(top).as_posix()
            # What the compiler leaves beside the sources says nothing that they do not.
            if "__pycache__" not in path.parts and not name.startswith(tuple(f"{each}/" for each in without)):
                yield name, path
    for config in config_folders():
        for path in config.rglob("*"):
            if path.is_file() and "published" not in path.relative_to(config).parts:
                yield f"config/{path.relative_to(config).as_posix()}", path
