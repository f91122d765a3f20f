"""What the result of a case depends on, as digests: earlier results are taken again while nothing of it changes."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence
from functools import cache
from importlib import import_module
from pathlib import Path

from ev_msgs_py.lockstep.methods import Method
from ev_msgs_py.parameters.config_folders import config_folders
from ev_msgs_py.parameters.data_file import files_read
from ev_sim.report.summary import PACKAGES, versions
from ev_sim.study.case import Case, run_of
from ev_sim.study.imported_files import imported_files

NEVER_DRIVES = ("ev_sim/commands", "ev_sim/dashboard", "ev_sim/report/page")
_OURS = ("ev_msgs_py", "ev_control", "ev_sim")
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
