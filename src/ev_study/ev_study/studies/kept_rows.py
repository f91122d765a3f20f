"""Rows of studies that were driven before: a stopped study goes on, and one that has grown drives only what is new.

What the result of a case depends on is a digest: it is taken again while nothing of it changes. (A
cache of the library's, such as joblib's, knows the arguments of a function, but neither the files
that it reads nor our sources.)
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ev_core.parameters.data_file import files_read
from ev_msgs_py.refusal import ParameterError
from ev_stack.recording.outcome import RunFailed
from ev_stack.recording.recording import Recording, save
from ev_stack.scenarios.scenario import Run
from ev_study.studies.digests import short_digest, text_of_method, text_of_report, text_of_study
from ev_study.studies.result_store import Results
from ev_study.studies.study import Case, CaseResult, Measure, run_of


def case_key(case: Case) -> str:
    """A digest of the content of a case, whatever its name."""
    files = [str(file) for file in case.files]
    content = (
        case.scenario,
        case.values,
        case.run,
        files,
        case.duration,
        case.vehicle,
        case.metrics,
    )
    return short_digest(content)


def row_key(study: str, case: Case) -> str:
    """A digest of all that what a study measures on a case depends on, but for `digest_of_sources`; as `run_key`."""
    key, _ = run_key(lambda: run_of(case), study, text_of_study(study))
    return key


def run_key(make: Callable[[], Run], *choices: object) -> tuple[str, Run]:
    """A digest of choices and of all that driving a run depends on, but for `digest_of_sources`; and the run.

    It is of the run that is made, with all its values, the names and texts of the files that were
    read for it, and the texts of its methods and of its report that are not ours. ParameterError if
    it is refused, ValueError if a law refuses its vehicle.
    """
    with files_read() as files:
        run = make()
        for configuration in run.configurations.values():
            configuration.create()
    roles = {
        role: (text_of_method(each.method), each.values())
        for role, each in run.configurations.items()
    }
    read = sorted((Path(name).name, digest) for name, digest in files.items())
    measured = run.report, text_of_report(run.report), run.metrics, run.course
    return short_digest((*choices, run.name, run.duration, measured, roles, read)), run


_ARRAY, _TUPLE = "array", "tuple"  # what JSON does not know, as objects with one of these keys


class KeptRows:
    """What the cases of a study have given, each under a digest of all that it depends on.

    ParameterError if none of the cases can be driven.
    """

    def __init__(self, results: Results, study: str, cases: Sequence[Case]) -> None:
        self._results, self._study = results, study
        self._keys = dict(self._resolved(cases))

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

    def key_of(self, case: Case) -> str | None:
        """The digest of a case; None if it is refused."""
        return self._keys.get(case.name)

    def of(self, case: Case) -> CaseResult | None:
        """The result of a case if it was driven before."""
        kept = self._results.get(_name(self._keys[case.name])) if case.name in self._keys else None
        return None if kept is None else result_of(kept, case.name)

    def keep(self, case: Case, result: CaseResult) -> None:
        """Write a result, at once; one that was refused is not worth it. RunFailed if its files are others by now."""
        if result.refused:
            return
        key = row_key(self._study, case)
        if key != self._keys.get(case.name):
            raise RunFailed(
                f"{case.name}: what it depends on has changed while the study was driven: start it again"
            )
        self._results[_name(key)] = as_json(result)


def _name(key: str) -> str:
    return f"{key}.row"


@dataclass(frozen=True, slots=True)
class MeasureAndSave:
    """What the worker of a case does where signals are kept as well, at a path that it has to be able to write to."""

    measure: Measure
    path: Path

    def __call__(self, recording: Recording, run: Run) -> Mapping[str, Any]:
        self.path.parent.mkdir(exist_ok=True)
        # The same case under another name, or another command, may write the same bits there at
        # this time.
        save(recording.shown or recording, self.path, replaces=True)
        return self.measure(recording, run)


def as_json(result: CaseResult) -> bytes:
    """A result as JSON, to the bit."""
    fields = {
        field.name: _encoded(getattr(result, field.name)) for field in dataclasses.fields(result)
    }
    return json.dumps(fields).encode()


def result_of(content: bytes, name: str) -> CaseResult:
    """The result that `as_json` was given, of a case that has this name now."""
    return CaseResult(**{**json.loads(content, object_hook=_decoded), "name": name})


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


def _decoded(fields: dict[str, Any]) -> Any:
    """An object of JSON, or what JSON does not know and `as_json` has made one of."""
    if fields.keys() == {_ARRAY, "type"}:
        return np.array(fields[_ARRAY], fields["type"])
    return tuple(fields[_TUPLE]) if fields.keys() == {_TUPLE} else fields
