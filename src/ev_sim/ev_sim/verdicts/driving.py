"""Drive what verdicts need, each run once."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from zipfile import is_zipfile

from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.lockstep.configuration import Configuration
from ev_sim.running.outcome import RunFailed
from ev_sim.running.recording.recording import Recording
from ev_sim.running.scenarios.scenario import Overrides, load_scenario
from ev_sim.study.case import Case, CaseResult, Measure
from ev_sim.study.command import arguments, study_cases
from ev_sim.study.depends import case_key
from ev_sim.study.study import study_named
from ev_sim.verdicts.kept import Keep, KeepMeasured, Kept, keep, measured_at, recording_at
from ev_sim.verdicts.need import Driven, Need, ScenarioRuns, StudyCases, StudyNeed

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
