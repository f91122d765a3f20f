"""Verdicts from runs with changed parameters, driven in this process if not kept yet."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache

from ev_core.compiling.user_cache import cache_folder
from ev_study.studies.driving import Keep
from ev_study.studies.result_store import ResultStore
from ev_study.studies.study import Case, CaseResult, Measure, drive_case
from ev_study.verdicts.need import Driven, Need, ScenarioNeed, Value, drive, kept_by_user
from ev_study.verdicts.sources import Published, published, sources
from ev_study.verdicts.verdict import Verdict, verdict


def verdict_on(id: str, *changed: Value) -> Verdict:
    """Judge an id by runs with changed parameters (node, name, value).

    Slow needs are driven, too.
    """
    return verdict_from(id, lambda need: _with(need, changed))


def verdict_from(id: str, changed: Callable[[Need], Need]) -> Verdict:
    """Verdict on an id from its changed needs, such as a study with other options."""
    of = _find(id)
    return verdict(of, [driven(changed(need)) for need in of.needs])


@cache
def driven(need: Need) -> Driven:
    """Drive a need, once in this process."""
    return drive([need], _kept(), drive_here)[need]


def drive_here(
    cases: Sequence[Case],
    measures: Sequence[Measure],
    keep: Keep = lambda number, result: None,
) -> list[CaseResult]:
    """Drive cases one after the other, without worker processes."""
    results = []
    for number, (case, measure) in enumerate(zip(cases, measures, strict=True)):
        results.append(drive_case(case, measure))
        keep(number, results[-1])
    return results


def _find(id: str) -> Published:
    return next(published(source)[id] for source in sources() if id in published(source))


def _with(need: Need, changed: Sequence[Value]) -> Need:
    assert not changed or isinstance(need, ScenarioNeed), (
        f"{need.command} is a study: change its options instead"
    )
    return (
        replace(need, values=(*need.values, *changed)) if isinstance(need, ScenarioNeed) else need
    )


@cache
def _kept() -> ResultStore:
    """Results kept by scripts/run.sh verdicts, under a digest of all that they depend on."""
    return kept_by_user(cache_folder() / "results")
