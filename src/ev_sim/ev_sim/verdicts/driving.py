"""Drive what verdicts need, each run once."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any
from zipfile import is_zipfile

from ev_core.compiling.machine_code import age
from ev_core.compiling.user_cache import cache_folder, read_checked, write_checked
from ev_core.lockstep.configuration import Configuration
from ev_msgs_py.contract.roles import MASTER
from ev_sim.recording.outcome import RunFailed
from ev_sim.recording.recording import Recording, load, save
from ev_sim.scenarios.scenario import Overrides, Run, load_scenario
from ev_sim.study.kept_rows import NEVER_DRIVES, as_json, case_key, decoded, digest_of_sources, result_of
from ev_sim.study.run_study import arguments, study_cases
from ev_sim.study.study import Case, CaseResult, Measure, study_named
from ev_sim.verdicts.need import Driven, Need, ScenarioRuns, StudyCases, StudyNeed

_ONLY_JUDGES = (*NEVER_DRIVES, "ev_sim/verdicts", "ev_sim/figures")
_ONLY_MEASURES = ("ev_sim/report", "ev_sim/study")
_DIGEST = "[0-9a-f]" * 24
_FOLDERS = 3  # of each kind: those of other checkouts and branches come back


@dataclass(frozen=True, slots=True)
class Keep:
    """What a worker does with the signals of a run of a scenario: it writes them where they are looked for."""

    path: Path

    def __call__(self, recording: Recording, run: Run) -> Mapping[str, Any]:
        with suppress(FileExistsError):  # another command has driven the same meanwhile
            save(recording, self.path)
        return {}


@dataclass(frozen=True, slots=True)
class KeepMeasured:
    """What a worker does with the case of a study: it measures and writes, so that what is done outlives a stop."""

    path: Path
    measure: Measure

    def __call__(self, recording: Recording, run: Run) -> Mapping[str, Any]:
        measured = self.measure(recording, run)
        keep(CaseResult("", measured), self.path)
        return measured


def keep(result: CaseResult, path: Path) -> None:
    """Write what a study has measured on a case, or why it was refused."""
    write_checked(path, json.dumps(as_json(result)).encode())


class Kept:
    """A folder with recordings of scenarios and with what studies have measured.

    Files stand under a digest of all sources, configuration files and versions of packages they depend on; what was
    kept of other sources is removed, but for that which was asked for last.
    """

    def __init__(self, folder: Path) -> None:
        self._recordings = folder / f"recordings_{digest_of_sources(_ONLY_JUDGES + _ONLY_MEASURES, config=True)}"
        self._measured = folder / f"measured_{digest_of_sources(_ONLY_JUDGES, config=True)}"
        for each in (self._recordings, self._measured):
            each.mkdir(parents=True, exist_ok=True)
            os.utime(each)
            ours = folder.glob(f"{each.name.partition('_')[0]}_{_DIGEST}")
            others = sorted(ours, key=age)
            for other in others[_FOLDERS:]:
                for file in (*other.glob("*.npz"), *other.glob("*.json")):
                    file.unlink(missing_ok=True)  # another command may be doing the same
                with suppress(OSError):  # what we have not written stays
                    other.rmdir()

    def recording(self, case: Case) -> Path:
        """Where the signals of a case are, or have to be written."""
        return self._recordings / f"{case_key(case)}.npz"

    def measured(self, study: str, case: Case) -> Path:
        """Where what a study has measured on a case is, or has to be written."""
        return self._measured / f"{study}_{case_key(case)}.json"


def kept_by_user() -> Kept:
    """What stands in the cache folder of the user, for all checkouts."""
    return Kept(cache_folder() / "verdicts")


def measured_at(path: Path, name: str) -> CaseResult | None:
    """What a study has measured on a case, which is called by this name; None if it has not yet."""
    kept = read_checked(path)
    return None if kept is None else result_of(json.loads(kept, object_hook=decoded), name)


@lru_cache(maxsize=6)  # one of a whole cycle has 80 MB
def recording_at(path: Path) -> Recording:
    """The signals in a file; the last ones stay in memory."""
    return load(path)


Drive = Callable[[Sequence[Case], Sequence[Measure]], Sequence[CaseResult]]


def drive(needs: Iterable[Need], kept: Kept, drive_cases: Drive) -> dict[Need, Driven]:
    """What was driven for each need; what `kept` already has is not driven again.

    `drive_cases` drives cases, each with its own function that measures, and returns the results in their order.
    ParameterError if a scenario or study is refused, RunFailed if a run of a scenario cannot be driven.
    """
    wanted = [_Resolved.of(need) for need in dict.fromkeys(needs)]
    found = [job for each in wanted for job in _missing(each, kept)]
    jobs = list({(study, case_key(case)): (study, case, measure) for study, case, measure in found}.values())
    results = drive_cases([case for _, case, _ in jobs], [measure for *_, measure in jobs]) if jobs else []
    for (study, case, _), result in zip(jobs, results, strict=True):
        if result.refused and not study:
            raise RunFailed(f"{case.name}: {result.refused}")
        if result.refused:
            keep(result, kept.measured(study, case))
    return {each.need: _driven(each, kept) for each in wanted}


def cases_of(need: Need) -> list[Case]:
    """What has to be driven for a need."""
    return _Resolved.of(need).cases


@dataclass(frozen=True, slots=True)
class _Resolved:
    """A need with its cases; `first` are the configurations of the first run of a scenario."""

    need: Need
    cases: list[Case]
    first: Mapping[str, Configuration] | None = None

    @classmethod
    def of(cls, need: Need) -> _Resolved:
        if isinstance(need, StudyNeed):
            return cls(need, study_cases(study_named(need.study), arguments(need.study, need.options)))
        overrides = Overrides(values=need.values, duration=need.duration)
        runs = load_scenario(need.scenario, overrides, only=need.runs).runs
        cases = [
            Case(f"{need.command} {run.name}", need.scenario, need.values, run.name, duration=need.duration)
            for run in runs
        ]
        return cls(need, cases, runs[0].configurations)


def _missing(of: _Resolved, kept: Kept) -> Iterator[tuple[str, Case, Measure]]:
    for case in of.cases:
        if isinstance(of.need, StudyNeed):
            path = kept.measured(of.need.study, case)
            if measured_at(path, case.name) is None:
                yield of.need.study, case, KeepMeasured(path, study_named(of.need.study).measure)
        elif not is_zipfile(kept.recording(case)):  # nor is it where a crash has cut it off
            kept.recording(case).unlink(missing_ok=True)
            yield "", case, Keep(kept.recording(case))


def _driven(of: _Resolved, kept: Kept) -> Driven:
    if isinstance(of.need, StudyNeed):
        results = {case.name: measured_at(kept.measured(of.need.study, case), case.name) for case in of.cases}
        return StudyCases(results, arguments(of.need.study, of.need.options))
    assert of.first is not None
    parameters = {role: configuration.values() for role, configuration in of.first.items()}
    recordings = _Recordings({case.run: kept.recording(case) for case in of.cases})
    return ScenarioRuns(recordings, of.first[MASTER].common.vehicle, parameters)


@dataclass(frozen=True, eq=False)
class _Recordings(Mapping[str, Recording]):
    """Recordings by name of the run, read when they are asked for."""

    paths: Mapping[str, Path]

    def __getitem__(self, name: str) -> Recording:
        return recording_at(self.paths[name])

    def __iter__(self) -> Iterator[str]:
        return iter(self.paths)

    def __len__(self) -> int:
        return len(self.paths)
