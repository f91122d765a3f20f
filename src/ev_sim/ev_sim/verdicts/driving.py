"""Drive what verdicts need, each run once."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ev_msgs_py.contract.roles import MASTER
from ev_sim.run.outcome import RunFailed
from ev_sim.run.recording.recording import Recording
from ev_sim.run.scenarios.scenario import Overrides, Scenario, load_scenario
from ev_sim.study.case import Case, CaseResult, Measure
from ev_sim.study.run_study import arguments, study_cases
from ev_sim.study.study import study_named
from ev_sim.verdicts.kept import Keep, KeepMeasured, Kept, case_key, keep, measured_at, recording_at
from ev_sim.verdicts.need import Driven, Need, ScenarioNeed, ScenarioRuns, StudyCases, StudyNeed

Drive = Callable[[Sequence[Case], Sequence[Measure]], Sequence[CaseResult]]


def drive(needs: Iterable[Need], kept: Kept, drive_cases: Drive) -> dict[Need, Driven]:
    """What was driven for each need; what `kept` already has is not driven again.

    `drive_cases` drives cases, each with its own function that measures, and returns the results in their order.
    ParameterError if a scenario or study is refused, RunFailed if a run of a scenario cannot be driven.
    """
    wanted = list(dict.fromkeys(needs))
    found = [job for need in wanted for job in _missing(need, kept)]
    jobs = list({(study, case_key(case)): (study, case, measure) for study, case, measure in found}.values())
    results = drive_cases([case for _, case, _ in jobs], [measure for *_, measure in jobs]) if jobs else []
    for (study, case, _), result in zip(jobs, results, strict=True):
        if result.refused and not study:
            raise RunFailed(f"{case.name}: {result.refused}")
        if result.refused:
            keep(result, kept.measured(study, case))
    return {need: _driven(need, kept) for need in wanted}


def cases_of(need: Need) -> list[Case]:
    """What has to be driven for a need."""
    if isinstance(need, StudyNeed):
        return study_cases(study_named(need.study), arguments(need.study, need.options))
    runs = [run.name for run in _scenario(need).runs if not need.runs or run.name in need.runs]
    return [Case(f"{need.command} {run}", need.scenario, need.values, run, duration=need.duration) for run in runs]


def _missing(need: Need, kept: Kept) -> Iterator[tuple[str, Case, Measure]]:
    for case in cases_of(need):
        if isinstance(need, StudyNeed):
            if not (path := kept.measured(need.study, case)).exists():
                yield need.study, case, KeepMeasured(path, study_named(need.study).measure)
        elif not kept.recording(case).exists():
            yield "", case, Keep(kept.recording(case))


def _scenario(need: ScenarioNeed) -> Scenario:
    return load_scenario(need.scenario, Overrides(values=need.values, duration=need.duration))


def _driven(need: Need, kept: Kept) -> Driven:
    cases = cases_of(need)
    if isinstance(need, StudyNeed):
        results = {case.name: measured_at(kept.measured(need.study, case), case.name) for case in cases}
        return StudyCases(results, arguments(need.study, need.options))
    first = next(run.configurations for run in _scenario(need).runs if not need.runs or run.name in need.runs)
    parameters = {role: configuration.values() for role, configuration in first.items()}
    recordings = _Recordings({case.run: kept.recording(case) for case in cases})
    return ScenarioRuns(recordings, first[MASTER].common.vehicle, parameters)


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
