"""Cases of a study on workers: what they need is loaded once, and each gives a row."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import suppress

from ev_stack.recording.offline import graph_run, run_offline
from ev_stack.running.beforehand import compile_for
from ev_stack.scenarios.records import Run
from ev_study.studies.study import Case, CaseResult, Measure, drive_case, run_of
from ev_study.studies.workers import HERE, Job, Workers, perform_jobs

_SAMPLE = 1.0  # s of simulated time by which the speed of a case is measured

Keep = Callable[[int, CaseResult], None]  # with number and result of a case


def drive_cases(
    cases: Sequence[Case],
    measure: Measure | Sequence[Measure],
    keep: Keep = lambda number, result: None,
    workers: Workers = HERE,
    bar: tuple[str, int] = ("driving", 0),
) -> list[CaseResult]:
    """Drive cases and return their results, in their order, however many workers there are.

    `measure` is one function for all cases, or one for each of them. `keep` is called with number
    and result of each as it comes. `bar` has the name of the progress bar and the number of runs
    before these. Raises what `perform_jobs` does.
    """
    # Workers elsewhere compile for themselves.
    if workers.scheduler is None:
        load_for(run_of_each_kind(cases))
    measures = [measure] * len(cases) if callable(measure) else measure
    given = zip(cases, measures, strict=True)
    jobs = [Job(case.name, drive_case, (case, of_case)) for case, of_case in given]
    results: dict[int, CaseResult] = {}

    def done(number: int, result: CaseResult) -> None:
        results[number] = result
        keep(number, result)

    name, before = bar
    perform_jobs(name, jobs, done, workers, before)
    return [results[number] for number in range(len(jobs))]


def run_of_each_kind(cases: Sequence[Case]) -> list[Run]:
    """Return a run of each kind of cases: within a kind all have the same methods and options."""
    kinds = {}
    for case in cases:
        methods = []
        for node, name, value in case.values:
            # A switch may be an option of a method, with which it is other code.
            if name == "method" or isinstance(value, bool):
                methods.append(f"{node}.{name} {value}")
        # The last case of a kind stays: other values compile to the same code.
        kinds[case.scenario, case.run, case.vehicle, case.files, *methods] = case
    runs = []
    for case in kinds.values():
        with suppress(ValueError):  # a case that is refused comes back as refused when it is driven
            runs.append(run_of(case))
    return runs


def load_for(runs: Sequence[Run]) -> None:
    """Compile what runs need and load the code of the first: workers are forked off with it."""
    compile_for(runs, in_nodes=False)
    for run in runs[:1]:
        with suppress(ValueError):
            # No step is driven: only the code is loaded.
            graph_run(run.configurations, 0.0)


def estimated_time(cases: Sequence[Case], workers: Workers) -> float:
    """Return about how long cases take here [s], by the first that is not refused; 0 if all are.

    What it needs is compiled before; others may need more.
    """
    for case in cases:
        with suppress(ValueError):
            start = time.monotonic()
            run = run_of(case)
            resolving = time.monotonic() - start
            compile_for([run], in_nodes=False)
            # Twice: only the second time is that of a run.
            _timed(run, 0.0)  # loads what all need
            beginning = _timed(run, 0.0)
            sample = min(_SAMPLE, run.duration)
            # A run of no length has the same beginning: what is left is the rate.
            rate = max(_timed(run, sample) - beginning, 0.0) / sample
            each = resolving + beginning + rate * run.duration
            return each * len(cases) / min(workers.here, len(cases))
    return 0.0


def _timed(run: Run, duration: float) -> float:
    """Wall time of a run that is this long [s]."""
    start = time.monotonic()
    run_offline(run.configurations, duration)
    return time.monotonic() - start
