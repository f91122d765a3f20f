"""What a study has driven, on disk: one that was stopped goes on, and one that has grown drives only what is new.

What the result of a case depends on is a digest: it is taken again while nothing of it changes. (A cache of the
library's, such as joblib's, knows the arguments of a function, but neither the files that it reads nor our sources.)
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ev_core.parameters.data_file import SIGNALS, files_read, read_data
from ev_msgs_py.refusal import ParameterError
from ev_stack.recording.outcome import RunFailed
from ev_stack.recording.recording import Recording, atomic_file, save
from ev_stack.scenarios.scenario import Run
from ev_study.studies.digests import digest_of_sources, short_digest, text_of_method, text_of_report, text_of_study
from ev_study.studies.study import Case, CaseResult, Measure, run_of


def case_key(case: Case) -> str:
    """A digest of the content of a case, whatever its name."""
    files = [str(file) for file in case.files]
    content = (case.scenario, case.values, case.run, files, case.duration, case.vehicle, case.metrics)
    return short_digest(content)


def row_key(study: str, case: Case) -> str:
    """A digest of all that what a study measures on a case depends on, but for `digest_of_sources`; as `run_key`."""
    key, _ = run_key(lambda: run_of(case), study, text_of_study(study))
    return key


def run_key(make: Callable[[], Run], *choices: object) -> tuple[str, Run]:
    """A digest of choices and of all that driving a run depends on, but for `digest_of_sources`; and the run.

    It is of the run that is made, with all its values, the names and texts of the files that were read for it, and the
    texts of its methods and of its report that are not ours. ParameterError if it is refused, ValueError if a law
    refuses its vehicle.
    """
    with files_read() as files:
        run = make()
        for configuration in run.configurations.values():
            configuration.create()
    roles = {role: (text_of_method(each.method), each.values()) for role, each in run.configurations.items()}
    read = sorted((Path(name).name, digest) for name, digest in files.items())
    measured = run.report, text_of_report(run.report), run.metrics, run.course
    return short_digest((*choices, run.name, run.duration, measured, roles, read)), run


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
