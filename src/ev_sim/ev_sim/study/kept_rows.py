"""What a study has driven, on disk: one that was stopped goes on, and one that has grown drives only what is new.

What the result of a case depends on is a digest: it is taken again while nothing of it changes. (A cache of the
library's, such as joblib's, knows the arguments of a function, but neither the files that it reads nor our sources.)
"""

from __future__ import annotations

import ast
import dataclasses
import hashlib
import json
import sys
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from importlib.util import find_spec, resolve_name
from pathlib import Path
from typing import Any

import numpy as np

from ev_core.methods.register import Method
from ev_core.parameters.data_file import SIGNALS, config_folders, files_read, read_data
from ev_msgs_py.refusal import ParameterError
from ev_sim.recording.outcome import RunFailed
from ev_sim.recording.recording import Recording, atomic_file, save
from ev_sim.report.summary import PACKAGES, versions
from ev_sim.scenarios.scenario import Run
from ev_sim.study.study import Case, CaseResult, Measure, run_of

_INSTALLED = frozenset(("site-packages", "dist-packages"))


def imported_files(module: str, but: Collection[str]) -> list[Path]:
    """Those of a module by its name, apart from Python's own and those of some packages; libraries in C as well.

    The imports of other installed packages are left out.
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
    package = module if file.name == "__init__.py" else module.rpartition(".")[0]
    for node in ast.walk(ast.parse(file.read_bytes() if file.suffix == ".py" else "")):
        if isinstance(node, ast.Import | ast.ImportFrom):
            names = [alias.name for alias in node.names]
            if isinstance(node, ast.ImportFrom):
                base = resolve_name("." * node.level + (node.module or ""), package)
                names = [base, *(f"{base}.{name}" for name in names)]
            for name in names:
                parts = name.split(".")
                yield from (".".join(parts[: n + 1]) for n in range(len(parts)))


NEVER_DRIVES = ("ev_sim/commands", "ev_sim/dashboard", "ev_sim/report/page")
_OURS = ("ev_msgs_py", "ev_core", "ev_control", "ev_sim", "ev_papers")
_LENGTH = 24  # hexadecimal digits


def case_key(case: Case) -> str:
    """A digest of the content of a case, whatever its name."""
    files = [str(file) for file in case.files]
    content = (case.scenario, case.values, case.run, files, case.duration, case.vehicle, case.metrics)
    return short_digest(content)


def row_key(study: str, case: Case) -> str:
    """A digest of all that what a study measures on a case depends on, but for `digest_of_sources`; as `run_key`."""
    key, _ = run_key(lambda: run_of(case), study)
    return key


def run_key(make: Callable[[], Run], *choices: object) -> tuple[str, Run]:
    """A digest of choices and of all that driving a run depends on, but for `digest_of_sources`; and the run.

    It is of the run that is made, with all its values, the names and texts of the files that were read for it, and the
    texts of the methods that are not ours. ParameterError if it is refused, ValueError if a law refuses its vehicle.
    """
    with files_read() as files:
        run = make()
        for configuration in run.configurations.values():
            configuration.create()
    roles = {role: (_text_of(each.method), each.values()) for role, each in run.configurations.items()}
    read = sorted((Path(name).name, digest) for name, digest in files.items())
    return short_digest((*choices, run.name, run.duration, run.report, run.metrics, run.course, roles, read)), run


def _text_of(method: Method) -> str:
    """A digest of the texts of a method and of what they import; empty if it is ours."""
    return "" if method.package in _OURS else _texts_of(method.documented.__module__)


@cache
def _texts_of(module: str) -> str:
    return _digest("", ((path.name, path) for path in imported_files(module, but=(*_OURS, *PACKAGES))))


def digest_of_sources(without: Sequence[str] = NEVER_DRIVES, config: bool = False) -> str:
    """The digest of our sources but for some folders, of package versions, and of the config folders if wanted."""
    return _digest(repr(sorted(versions().items())), [*_sources(without), *(_config() if config else ())])


def short_digest(content: object) -> str:
    """Some digits that change with what is written of a content."""
    return hashlib.sha256(repr(content).encode()).hexdigest()[:_LENGTH]


def _digest(head: str, files: Iterable[tuple[str, Path]]) -> str:
    digest = hashlib.sha256(head.encode())
    for name, path in sorted(files):
        digest.update(f"{name}\0".encode() + path.read_bytes())
    return digest.hexdigest()[:_LENGTH]


def _sources(without: Sequence[str]) -> Iterable[tuple[str, Path]]:
    for package in _OURS:
        top = Path(import_module(package).__file__ or "").parent.parent
        for path in (top / package).rglob("*.py"):
            name = path.relative_to(top).as_posix()
            # What the compiler leaves beside the sources follows from them.
            if "__pycache__" not in path.parts and not name.startswith(tuple(f"{each}/" for each in without)):
                yield name, path


def _config() -> Iterable[tuple[str, Path]]:
    for config in config_folders():
        for path in config.rglob("*"):
            if path.is_file() and "published" not in path.relative_to(config).parts:
                yield path.relative_to(config).as_posix(), path


DRIVEN = "driven.jsonl"
_DIGEST = "digest"  # of the rest of a line
_ARRAY, _TUPLE = "array", "tuple"  # what JSON does not know, as objects with one of these keys


class KeptRows:
    """A line for each case that was driven, with a digest of all that its result depends on.

    What was driven with other sources is left out; what is of other cases, or of another study, stays. ParameterError
    if none of the cases can be driven.
    """

    def __init__(self, folder: Path, study: str, cases: Sequence[Case], anew: bool = False) -> None:
        self._path, self._study = folder / DRIVEN, study
        self._sources = digest_of_sources()
        self._keys = dict(self._resolved(cases))
        text = read_data(self._path, SIGNALS).decode(errors="replace") if self._path.is_file() else ""
        self._gap = "\n" if text and not text.endswith("\n") else ""
        self._results = {line["case"]: line["result"] for line in self._lines(text)}
        for key in self._keys.values() if anew else ():
            self._results.pop(key, None)

    def _resolved(self, cases: Sequence[Case]) -> Iterator[tuple[str, str]]:
        """Name and key of each case that is not refused."""
        reasons = []
        for case in cases:
            try:
                yield case.name, row_key(self._study, case)
            except ValueError as error:  # it comes back as refused when it is driven
                reasons.append(f"{case.name}: {error}")
        if len(reasons) == len(cases):
            raise ParameterError(f"none of {len(cases)} runs can be driven; {reasons[0]}")

    @property
    def files(self) -> list[str]:
        """The names of what is worth to be kept, with signals; none if nothing of it holds any more."""
        return [DRIVEN, *map(_signals_of_key, self._results)] if self._results else []

    def signals_of(self, case: Case) -> str | None:
        """Where the signals of a case are kept, below the folder of its study; None if it is refused."""
        key = self._keys.get(case.name)
        return None if key is None else _signals_of_key(key)

    def of(self, case: Case) -> CaseResult | None:
        """The result of a case if it was driven before."""
        found = self._results.get(self._keys.get(case.name, ""))
        return None if found is None else result_of(found, case.name)

    def keep(self, case: Case, result: CaseResult) -> None:
        """Write a result, at once; one that was refused is not worth it. RunFailed if its files are others by now."""
        if result.refused:
            return
        key = row_key(self._study, case)
        if key != self._keys.get(case.name):
            raise RunFailed(f"{case.name}: what it depends on has changed while the study was driven: start it again")
        line = {"sources": self._sources, "case": key, "result": as_json(result)}
        line |= {_DIGEST: short_digest(json.dumps(line))}
        if self._path.exists() and self._path.stat().st_nlink > 1:  # under its other name it is a copy of the user's
            with atomic_file(self._path, replaces=True) as copy:
                copy.write(self._path.read_bytes())
        with self._path.open("a", encoding="utf-8") as file:
            file.write(f"{self._gap}{json.dumps(line)}\n")
        self._gap = ""

    def _lines(self, text: str) -> Iterable[dict[str, Any]]:
        for each in text.splitlines():
            try:
                line = json.loads(each)
                is_whole = line.pop(_DIGEST) == short_digest(json.dumps(line))
            except (
                ValueError,
                TypeError,
                LookupError,
                AttributeError,
                RecursionError,
            ):  # half a line, of a killed study
                continue
            if is_whole and line["sources"] == self._sources:
                yield json.loads(each, object_hook=decoded)


@dataclass(frozen=True, slots=True)
class MeasureAndSave:
    """What the worker of a case does where signals are kept as well, at a path that it has to be able to write to."""

    measure: Measure
    path: Path

    def __call__(self, recording: Recording, run: Run) -> Mapping[str, Any]:
        self.path.parent.mkdir(exist_ok=True)
        with suppress(FileExistsError):  # of a case that is the same under another name
            save(recording.shown or recording, self.path)
        return self.measure(recording, run)


def _signals_of_key(key: str) -> str:
    return f"signals/{key}.npz"


def as_json(result: CaseResult) -> dict[str, Any]:
    """A result as JSON takes it, to the bit."""
    return {field.name: _encoded(getattr(result, field.name)) for field in dataclasses.fields(result)}


def result_of(fields: Mapping[str, Any], name: str) -> CaseResult:
    """The result that `as_json` was given, `decoded`, of a case that is called so now."""
    return CaseResult(**{**fields, "name": name})


def _encoded(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return {_ARRAY: value.tolist(), "type": value.dtype.str}
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, tuple):
        return {_TUPLE: [_encoded(each) for each in value]}
    if isinstance(value, list):
        return [_encoded(each) for each in value]
    if isinstance(value, Mapping):
        return {key: _encoded(each) for key, each in value.items()}
    return value


def decoded(fields: dict[str, Any]) -> Any:
    """For `json.loads`: an object of JSON, or what JSON does not know and `as_json` has made one of."""
    if fields.keys() == {_ARRAY, "type"}:
        return np.array(fields[_ARRAY], fields["type"])
    return tuple(fields[_TUPLE]) if fields.keys() == {_TUPLE} else fields
