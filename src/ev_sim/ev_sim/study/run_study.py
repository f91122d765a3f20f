"""Drive a study from the command line: its cases on workers, then tables, metrics and figures."""

from __future__ import annotations

import argparse
import hashlib
import time
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from ev_msgs_py.parameters.declaration import ParameterError
from ev_msgs_py.parameters.shown import quoted
from ev_sim.commands.command_line import add_outputs, add_overrides, command_of, overrides
from ev_sim.report.figures.saving import figure_files, save_figures
from ev_sim.report.metric import Metric
from ev_sim.report.metric_table import print_metrics
from ev_sim.report.summary import versions, write_summary
from ev_sim.report.table_files import TABLES, write_tables
from ev_sim.running.files_of_run import OF_ALL_RUNS, PAGE, SUMMARY
from ev_sim.running.outcome import RunFailed
from ev_sim.running.output_folder import OutputFolder
from ev_sim.running.progress_bar import bar_of_runs
from ev_sim.running.scenarios.scenario import Run, refuse_unused_values
from ev_sim.study.case import Case, CaseResult, run_of
from ev_sim.study.kept_rows import NAME, KeptRows, MeasureAndSave, signals_of
from ev_sim.study.study import Results, Study, study_named
from ev_sim.study.workers import drive_cases


def arguments(name: str, argv: Sequence[str]) -> argparse.Namespace:
    """Parse the command line of a study; argparse ends the process with status 2 for words it does not know."""
    study = study_named(name)
    parser = argparse.ArgumentParser(prog=f"run.sh {name}", description=study.ABOUT)
    parser.add_argument("--scheduler", metavar="tcp://HOST:PORT", help="a dask scheduler instead of this machine")
    parser.add_argument("--workers", type=_positive, metavar="N", help="worker processes here; default: one per core")
    parser.add_argument("--out", type=Path, metavar="DIR", help=f"output folder; default results/{name}")
    parser.add_argument("--anew", action="store_true", help="drive again what was driven before with this --out")
    parser.add_argument("--signals", action="store_true", help="keep the signals of every run, in DIR/signals")
    add_overrides(parser)
    add_outputs(parser)
    study.add_options(parser)
    return parser.parse_args(argv)


def study_cases(study: Study, given: argparse.Namespace) -> list[Case]:
    """The cases of a study with what the command line changes in all of them."""
    common = overrides(given)
    return [
        Case(
            case.name,
            case.scenario,
            (*case.values, *common.prepared, *common.values),
            case.run,
            (*case.files, *common.files),
            case.duration if common.duration is None else common.duration,
            common.vehicle or case.vehicle,
        )
        for case in study.cases(given)
    ]


def run_study(name: str, argv: Sequence[str]) -> None:
    """Drive all cases of a study and report; raises what `ev_sim.commands.run_scenario.main` catches."""
    study, given = study_named(name), arguments(name, argv)
    cases = study_cases(study, given)
    run = _first_that_can_be_driven(cases)
    _refuse_unused(study, given, cases)
    out = given.out or Path("results") / name
    rows = KeptRows(out, name, cases, run)
    names = [*OF_ALL_RUNS, *TABLES, NAME, *(map(signals_of, cases) if given.signals else ())]
    with OutputFolder(out, f"study {name}", names, keeps=() if given.anew else rows.files) as folder:
        start = time.monotonic()
        driven, before = _drive(name, given, cases, folder.directory, rows)
        wall_time = time.monotonic() - start
        results = {result.name: result for result in driven}
        if all(result.refused for result in driven):
            raise RunFailed(f"none of {len(driven)} runs was driven; {driven[0].name}: {driven[0].refused}")
        metrics = study.metrics(given, results)

        figures = study.figures(given, results)
        folder.claim(figure_files(figures, given.figures))
        save_figures(figures, folder.directory, given.figures)
        content = {**_summary(name, given, cases, results, metrics, wall_time), "command": command_of([name, *argv])}
        write_summary(folder.directory / SUMMARY, content)
        if hasattr(study, "table"):
            write_tables(folder.directory, *study.table(given, results))
        tables = study.tables(given, results)
        if not given.no_report:
            from ev_sim.report.page.images import images_of
            from ev_sim.report.page.measured import measured_signals
            from ev_sim.report.page.writing import Page, write_page

            signals = measured_signals({case: result.measured for case, result in results.items()})
            shown = Page(name, {"": content}, signals, images_of(figures, folder.directory), tables)
            write_page(shown, folder.directory / PAGE)
    if tables:
        print(tables, end="\n\n")
    print_metrics(metrics)
    for reason in dict.fromkeys(result.refused for result in driven if result.refused):
        print(f"not driven: {', '.join(result.name for result in driven if result.refused == reason)}: {reason}")
    _print_notes(driven)
    print(f"signal hash {content['signal_hash']}")
    again = f", {before} of them driven before (--anew drives them again)" if before else ""
    print(f"{len(cases)} runs, {content['simulated_time']:g} s in {wall_time:.1f} s{again}")
    page = "" if given.no_report else "report.html, "
    print(f"{page}figures and summary: {folder.directory}")


def _drive(
    name: str, given: argparse.Namespace, cases: Sequence[Case], folder: Path, rows: KeptRows
) -> tuple[list[CaseResult], int]:
    """The results of all cases, in their order, and how many of them were there already.

    RunFailed if signals of a case are asked for and not there in the end.
    """
    measure = study_named(name).measure
    paths = {case.name: folder / signals_of(case) for case in cases}
    found = {} if given.anew else {case.name: result for case in cases if (result := rows.of(case)) is not None}
    found = {key: result for key, result in found.items() if not given.signals or paths[key].exists()}
    missing = {case.name: case for case in cases if case.name not in found}
    with bar_of_runs(name, len(cases), len(found)) as bar:

        def heard(result: CaseResult) -> None:
            rows.keep(missing[result.name], result)
            bar.update()

        measures = [MeasureAndSave(measure, paths[each]) if given.signals else measure for each in missing]
        driven = drive_cases(list(missing.values()), measures, heard, given.scheduler, given.workers) if missing else []
    results = {**found, **{result.name: result for result in driven}}
    for case, result in results.items():
        if given.signals and not result.refused and not paths[case].exists():
            raise RunFailed(f"{case}: its worker has written no {paths[case]}, which --signals needs all to see")
    return [results[case.name] for case in cases], len(found)


def _print_notes(results: Sequence[CaseResult]) -> None:
    """Each note once, with the first case that has it."""
    cases: dict[str, list[str]] = {}
    for result in results:
        for note in result.notes:
            cases.setdefault(note, []).append(result.name)
    for note, names in cases.items():
        more = f" and {len(names) - 1} more" if len(names) > 1 else ""
        print(f"note: {names[0]}{more}: {note}")


def _first_that_can_be_driven(cases: Sequence[Case]) -> Run:
    """The first run that is not refused; ParameterError, before an earlier result is replaced, if there is none."""
    reason = ""
    for case in cases:
        try:
            return run_of(case)
        except ParameterError as error:
            reason = reason or f"{case.name}: {error}"
    raise ParameterError(f"none of {len(cases)} runs can be driven; {reason}")


def _refuse_unused(study: Study, given: argparse.Namespace, cases: Sequence[Case]) -> None:
    """ParameterError for what the command line sets or varies and no method of any case has."""
    alike = {(c.scenario, c.run, c.files, *(v for v in c.values if v[1] == "method")): c for c in cases}
    runs = []
    for case in alike.values():
        with suppress(ParameterError):  # a case that cannot be driven comes back as refused
            runs.append(run_of(case))
    varied = study.variations(given) if hasattr(study, "variations") else {}
    places = [(*name.split(".", 1), None) for name in varied if "." in name]
    refuse_unused_values([*overrides(given).values, *places], runs)


def _positive(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{quoted(text)} is refused, allowed is 1 or more")
    return int(text)


def _summary(
    name: str,
    given: argparse.Namespace,
    cases: Sequence[Case],
    results: Results,
    metrics: dict[str, Metric],
    wall_time: float,
) -> dict[str, Any]:
    """The content of summary.json; arrays that a study measured for its figures are left out."""
    hashes = "".join(f"{result.name}\0{result.signal_hash}\n" for result in results.values())
    return {
        "study": name,
        "about": study_named(name).ABOUT,
        "options": {key: str(value) for key, value in sorted(vars(given).items()) if value is not None},
        "metrics": {key: metric.as_json() for key, metric in metrics.items()},
        "signal_hash": hashlib.sha256(hashes.encode()).hexdigest(),
        "cases": {
            case.name: {
                "scenario": case.scenario,
                "run": case.run,
                "values": [list(value) for value in case.values],
                "signal_hash": results[case.name].signal_hash,
                "refused": results[case.name].refused,
                "notes": list(results[case.name].notes),
                "signals": signals_of(case) if given.signals else None,
                "measured": {
                    key: value
                    for key, value in results[case.name].measured.items()
                    if isinstance(value, str | int | float | bool | None)
                },
            }
            for case in cases
        },
        "simulated_time": sum(result.simulated_time for result in results.values()),
        "wall_time": wall_time,
        "versions": versions(),
    }
