"""Rows that were driven before: what was stopped goes on, and what has grown drives only the new.

How it works: a row is what one job has measured, such as a case of a study, or a law in a cell of a
board. It stands in a store under its key, a digest of all that it depends on beside our sources.
So it is taken again while nothing of it changes. (A cache of the library's, such as joblib's, knows
the arguments of a function, but neither the files that it reads nor our sources.)
"""

from __future__ import annotations

import dataclasses
import json
import zlib
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Generic, TypeVar

import numpy as np

from ev_core.parameters.data_file import files_read
from ev_msgs_py.refusal import ParameterError
from ev_stack.recording.outcome import RunFailed
from ev_stack.recording.recording import Recording, save
from ev_stack.scenarios.records import Run
from ev_study.studies.digests import (
    digest_of,
    short_digest,
    text_of_method,
    text_of_report,
    text_of_study,
)
from ev_study.studies.result_store import Results
from ev_study.studies.study import Case, Measure, run_of

Row = TypeVar("Row")  # a dataclass
# What JSON does not know is an object with one of these keys, which no metric can have as its name.
_ARRAY = "\0array"
_TUPLE = "\0tuple"


@dataclass(frozen=True, slots=True)
class Key:
    """A digest of all that a row depends on, and by path the SHA-256 of the files among that."""

    digest: str
    files: Mapping[str, str]

    @property
    def name(self) -> str:
        """Name of the row in the store."""
        return f"{self.digest}.row"

    def refuse_changed(self) -> None:
        """RunFailed if a file is another one by now: each job reads it again."""
        for path, digest in self.files.items():
            # A worker reads the file once more, and may have read another one than the key has.
            if not (Path(path).is_file() and digest_of(Path(path)) == digest):
                raise RunFailed(f"{path} has changed since the runs began: start them again")


def run_key(make: Callable[[], Run], *choices: object) -> tuple[Key, Run]:
    """Return the key of choices and of all that driving a run depends on; and the run.

    It is of the run that is made, with all its values, the names and texts of the files that were
    read for it, and the texts of its methods and of its report that are not ours. ParameterError if
    it is refused, ValueError if a law refuses its vehicle.
    """
    with files_read() as files:
        run = make()
        for configuration in run.configurations.values():
            # Laws read files (maps, policies) when they are made: those count, too.
            configuration.create()
    roles = {
        role: (text_of_method(configuration.method), configuration.values())
        for role, configuration in run.configurations.items()
    }
    # By name and content, not by path: the same run in another folder is the same.
    read = sorted((Path(name).name, digest) for name, digest in files.items())
    measured = run.report, text_of_report(run.report), run.metrics, run.course
    driven = run.name, run.duration, run.slow_ramp
    digest = short_digest((*choices, *driven, measured, roles, read))
    return Key(digest, files), run


def case_key(case: Case) -> str:
    """Return a digest of the content of a case, whatever its name."""
    files = [str(file) for file in case.files]
    of_run = case.scenario, case.values, case.run, files, case.duration, case.vehicle
    return short_digest((*of_run, case.metrics))


def row_key(study: str, case: Case) -> Key:
    """Return the key of what a study measures on a case; raises what `run_key` does."""
    key, _ = run_key(lambda: run_of(case), study, text_of_study(study))
    return key


def keys_of_cases(study: str, cases: Sequence[Case]) -> dict[str, Key]:
    """Return by name the keys of all cases that are not refused; ParameterError if all are."""
    keys = {}
    reasons = []
    shared: dict[str, Mapping[str, str]] = {}
    for case in cases:
        try:
            key = row_key(study, case)
        except ValueError as error:  # it comes back as refused when it is driven
            reasons.append(f"{case.name}: {error}")
            continue
        # Most of 100 000 cases read the same files: one list of them is enough.
        keys[case.name] = replace(key, files=shared.setdefault(repr(key.files), key.files))
    if len(reasons) == len(cases):
        raise ParameterError(f"none of {len(cases)} runs can be driven; {reasons[0]}")
    return keys


class KeptRows(Generic[Row]):
    """Rows of one kind in a store, by names of which each has a key."""

    def __init__(
        self, results: Results, kind: type[Row], keys: Mapping[Hashable, Key], anew: bool = False
    ) -> None:
        """Rows that are `anew` count as missing until they have been driven once more."""
        self._results = results
        self._kind = kind
        self._keys = keys
        self._forgotten = set(keys) if anew else set()

    @property
    def names(self) -> list[str]:
        """Names of the rows in the store."""
        return list(dict.fromkeys(key.name for key in self._keys.values()))

    @property
    def files(self) -> dict[str, str]:
        """SHA-256, by path, of the files that the rows depend on."""
        found: dict[str, str] = {}
        for key in self._keys.values():
            found |= key.files
        return found

    def get(self, name: Hashable) -> Row | None:
        """Return a row; None without one, or if the store has not what was written."""
        if name not in self._keys or name in self._forgotten:
            return None
        content = self._results.get(self._keys[name].name)
        return None if content is None else row_of(self._kind, content)

    def keep(self, name: Hashable, row: Row) -> None:
        """Write a row, at once; RunFailed if the files that it depends on are others by now."""
        if name not in self._keys:
            # A row without a key was refused then, and a file has been mended since.
            raise RunFailed(f"{name} was refused when the runs began: start them again")
        key = self._keys[name]
        key.refuse_changed()
        self._results[key.name] = as_json(row)
        self._forgotten.discard(name)


@dataclass(frozen=True, slots=True)
class MeasureAndSave:
    """Measures a case and saves its signals at a path, which its worker has to be able to write."""

    measure: Measure
    path: Path

    def __call__(self, recording: Recording, run: Run) -> Mapping[str, Any]:
        self.path.parent.mkdir(exist_ok=True)
        # The same case under another name, or another command, may write the same bits here.
        save(recording.shown or recording, self.path, replaces=True)
        return self.measure(recording, run)


def as_json(row: Any) -> bytes:
    """Return a row as compressed JSON, to the bit: commands are long and much alike."""
    fields = {of.name: _encoded(getattr(row, of.name)) for of in dataclasses.fields(row)}
    return zlib.compress(json.dumps(fields).encode())


def row_of(kind: type[Row], content: bytes) -> Row:
    """Return the row that `as_json` was given."""
    return kind(**json.loads(zlib.decompress(content), object_hook=_decoded))


def _encoded(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        # float.__repr__ in JSON gives the same bits when it is read again.
        return {_ARRAY: value.ravel().tolist(), "type": value.dtype.str, "shape": value.shape}
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, tuple):
        return {_TUPLE: [_encoded(each) for each in value]}
    if isinstance(value, list):
        return [_encoded(each) for each in value]
    if isinstance(value, Mapping):
        return {key: _encoded(each) for key, each in value.items()}
    return value


def _decoded(fields: dict[str, Any]) -> Any:
    """Return an object of JSON, or what `as_json` has made one of."""
    if _ARRAY in fields:
        return np.array(fields[_ARRAY], fields["type"]).reshape(fields["shape"])
    if _TUPLE in fields:
        return tuple(fields[_TUPLE])
    return fields
