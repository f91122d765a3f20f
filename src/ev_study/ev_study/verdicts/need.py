"""Runs that verdicts need, each driven once, and their results for a verdict.

How it works: what verdicts are about is stated as needs: a scenario with some values, or a study
with options. Equal needs are driven once. Each becomes cases with keys; what the store has under a
key is not driven again. Of a scenario the signals are kept as files, since measures of all kinds
read them; of a study only its rows.
"""

from __future__ import annotations

import argparse
import shlex
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NoReturn
from zipfile import is_zipfile

from ev_core.lockstep.configuration import Configuration
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.refusal import ParameterError, quoted
from ev_stack.command_line.options import add_changes, overrides
from ev_stack.measures.metric import Parameters, Runs
from ev_stack.recording.outcome import RunFailed
from ev_stack.recording.recording import Recording, load, save
from ev_stack.running.steering_angles import with_own_angles
from ev_stack.scenarios.records import Overrides, Run
from ev_stack.scenarios.scenario import load_scenario
from ev_study.studies.digests import NEVER_DRIVES, config_files, digest_of_sources
from ev_study.studies.driving import Keep
from ev_study.studies.kept_rows import KeptRows, Key, case_key, row_key
from ev_study.studies.result_store import RECORDING, ResultStore
from ev_study.studies.run_study import arguments, study_cases
from ev_study.studies.study import Case, CaseResult, Measure, Results, study_named, study_names

Value = tuple[str, str, Any]  # node, parameter, value
# Of the same kind: the signals that are kept do not depend on how they are judged or drawn.
_ONLY_JUDGES = (*NEVER_DRIVES, "ev_study/verdicts", "ev_stack/figures")


@dataclass(frozen=True, slots=True)
class ScenarioNeed:
    """Runs of a scenario: all of them, or those named, with some parameters (node, name, value) changed.

    `slow` marks what takes more than a few seconds.
    """

    scenario: str
    values: tuple[Value, ...] = ()
    runs: tuple[str, ...] = ()
    duration: float | None = None
    slow: bool = False

    @property
    def command(self) -> str:
        """Words that drive the same from the command line."""
        changed = [f"--set {node}.{name}={_word(value)}" for node, name, value in self.values]
        duration = [f"--duration {self.duration:g}"] if self.duration else []
        return " ".join([self.scenario, *changed, *duration])


def _word(value: Any) -> str:
    """A value as the command line takes it."""
    if isinstance(value, tuple):
        return f"[{','.join(map(_word, value))}]"
    return str(value).lower() if isinstance(value, bool) else str(value)


@dataclass(frozen=True, slots=True)
class StudyNeed:
    """All cases of a study with some options of its command line; `slow` as above."""

    study: str
    options: tuple[str, ...] = ()
    slow: bool = True

    @property
    def command(self) -> str:
        """Words that drive the same from the command line."""
        return " ".join([self.study, *self.options])


Need = ScenarioNeed | StudyNeed


def need_of(text: str) -> Need:
    """The need that a text means, which is as on the command line: a scenario, or a study with its options.

    A scenario may have --set, --duration, --runs (those that are driven, all if it is left out) and
    --slow; a study counts as slow unless there is --quick. ParameterError if the text is refused.
    """
    name, *words = shlex.split(text) or [""]
    # A study parses its own options, so its words are passed on as they are.
    if name in study_names():
        return StudyNeed(
            name, tuple(word for word in words if word != "--quick"), slow="--quick" not in words
        )
    parser = _Parser(add_help=False)
    add_changes(parser)
    parser.add_argument("--runs", nargs="+", default=())
    parser.add_argument("--slow", action="store_true")
    given, unknown = parser.parse_known_args(words)
    if not name or unknown:
        refused = quoted(" ".join(unknown) or text)
        raise ParameterError(
            f"what is driven: {refused} is refused, expected a scenario with --set, --duration,"
            " --runs"
        )
    found = overrides(given)
    values = tuple((node, name, _frozen(value)) for node, name, value in found.values)
    return ScenarioNeed(name, values, tuple(given.runs), found.duration, given.slow)


# argparse would end the process; a table of published numbers needs a line with its place.
class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        raise ParameterError(f"what is driven: {message}")


# A need is a key of dicts, so lists become tuples.
def _frozen(value: Any) -> Any:
    return tuple(map(_frozen, value)) if isinstance(value, list) else value


@dataclass(frozen=True)
class ScenarioRuns:
    """The runs of a scenario by name, their car, and the parameters of the first one."""

    runs: Runs
    vehicle: Vehicle
    parameters: Parameters


@dataclass(frozen=True)
class StudyCases:
    """Results of a study, and the options that it was given."""

    results: Results
    given: argparse.Namespace


Driven = ScenarioRuns | StudyCases


def kept_by_user(folder: Path | None = None) -> ResultStore:
    """Results kept for verdicts, by all sources, configuration files and packages as they are."""
    return ResultStore(digest_of_sources(_ONLY_JUDGES, config=True, others=True), folder)


def key_of(study: str, case: Case, config: Mapping[str, str]) -> Key:
    """Return the key of what a study measures on a case; of its signals without a study.

    Where the case may name a file, its name is not enough: then the run is made, and the texts of
    all files count that it reads. Else these stand in the config folders, which are `config`: their
    texts count for all.
    """
    key = Key(case_key(case), config)
    given = case.scenario, case.vehicle, case.files, tuple(value for _, _, value in case.values)
    # Only such a text may be the name of a file.
    if any(set("./").intersection(text) for text in _texts(given)):
        with suppress(ValueError):  # the case is refused, as it will be when it is driven
            key = row_key(study, case)
    return replace(key, digest=f"{study}_{key.digest}") if study else key


def _texts(of: Any) -> Iterator[str]:
    """The texts in some values, and names of files."""
    if isinstance(of, str | Path):
        yield str(of)
    for each in of if isinstance(of, tuple | list) else ():
        yield from _texts(each)


@dataclass(frozen=True, slots=True)
class _KeepSignals:
    """Writes the signals of a run in its worker: those of a whole cycle have 80 MB."""

    path: Path

    def __call__(self, recording: Recording, run: Run) -> Mapping[str, Any]:
        # A worker that was lost may have written them before.
        save(recording, self.path, replaces=True)
        return {}


# Many measures in a row ask for the same few runs; all of them together do not fit into memory.
_recording_at = lru_cache(maxsize=6)(load)

Drive = Callable[[Sequence[Case], Sequence[Measure], Keep], Sequence[CaseResult]]


def drive(needs: Iterable[Need], kept: ResultStore, drive_cases: Drive) -> dict[Need, Driven]:
    """Return what was driven for each need; what `kept` already has is not driven again.

    `drive_cases` drives cases, each with its own function that measures, and calls another one with
    the number and the result of each. ParameterError if a scenario or study is refused, RunFailed
    if a run of a scenario cannot be driven.
    """
    wanted = {need: _resolved(need) for need in dict.fromkeys(needs)}
    config = config_files()
    keys: dict[Need, list[Key]] = {}
    for need, (cases, _) in wanted.items():
        study = need.study if isinstance(need, StudyNeed) else ""
        keys[need] = [key_of(study, case, config) for case in cases]
    # Two needs may have a case in common.
    every = {key.digest: key for of in keys.values() for key in of}
    rows = KeptRows(kept, CaseResult, every)
    with TemporaryDirectory(dir=kept.folder) as driven:
        jobs: dict[str, tuple[Case, Measure]] = {}
        for need, (cases, _) in wanted.items():
            for case, key in zip(cases, keys[need], strict=True):
                if isinstance(need, ScenarioNeed):
                    # Nor is it one where a crash has cut it off.
                    if not is_zipfile(_signals(kept, key)):
                        path = Path(driven, f"{key.digest}{RECORDING}")
                        jobs[key.digest] = case, _KeepSignals(path)
                elif rows.get(key.digest) is None:
                    jobs[key.digest] = case, study_named(need.study).measure
        digests = list(jobs)

        def keep(number: int, result: CaseResult) -> None:
            key = every[digests[number]]
            _, measure = jobs[key.digest]
            if not isinstance(measure, _KeepSignals):
                # At once: a command that is stopped here has lost nothing.
                rows.keep(key.digest, result)
                return
            if result.refused:
                raise RunFailed(f"{result.name}: {result.refused}")
            # Signals come into the store only when they are those of the key.
            key.refuse_changed()
            measure.path.replace(_signals(kept, key))

        if jobs:
            drive_cases(*zip(*jobs.values(), strict=True), keep)
    found: dict[Need, Driven] = {}
    for need, (cases, first) in wanted.items():
        at = list(zip(cases, keys[need], strict=True))
        if isinstance(need, StudyNeed):
            results = {case.name: rows.get(key.digest) for case, key in at}
            # The row may have been driven under another name.
            results = {name: replace(row, name=name) for name, row in results.items()}
            found[need] = StudyCases(results, arguments(need.study, need.options))
            continue
        parameters = {role: configuration.values() for role, configuration in first.items()}
        recordings = _Recordings({case.run: _signals(kept, key) for case, key in at})
        found[need] = ScenarioRuns(recordings, first[MASTER].common.vehicle, parameters)
    return found


def _signals(kept: ResultStore, key: Key) -> Path:
    """Path of the signals of a run."""
    return kept.path(f"{key.digest}{RECORDING}")


def cases_of(need: Need) -> list[Case]:
    """Cases to drive for a need."""
    return _resolved(need)[0]


def _resolved(need: Need) -> tuple[list[Case], Mapping[str, Configuration]]:
    """The cases of a need, and the configurations of the first run of a scenario."""
    if isinstance(need, StudyNeed):
        return study_cases(study_named(need.study), arguments(need.study, need.options)), {}
    overrides = Overrides(values=need.values, duration=need.duration)
    runs = with_own_angles(load_scenario(need.scenario, overrides, only=need.runs)).runs
    cases = [
        Case(
            f"{need.command} {run.name}",
            need.scenario,
            need.values,
            run.name,
            duration=need.duration,
        )
        for run in runs
    ]
    return cases, runs[0].configurations


@dataclass(frozen=True, eq=False)
class _Recordings(Mapping[str, Recording]):
    """Recordings by name of the run, read when they are asked for."""

    paths: Mapping[str, Path]

    def __getitem__(self, name: str) -> Recording:
        return _recording_at(self.paths[name])

    def __iter__(self) -> Iterator[str]:
        return iter(self.paths)

    def __len__(self) -> int:
        return len(self.paths)
