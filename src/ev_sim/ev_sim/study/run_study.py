"""Drive a study from the command line: its cases on workers, then tables, metrics and figures."""

from __future__ import annotations

import argparse
import hashlib
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ev_msgs_py.refusal import LINE, ParameterError, shown
from ev_sim.command_line.options import command_of
from ev_sim.figures.figure import Figure
from ev_sim.figures.saving import figure_files, save_figures
from ev_sim.measures.metric import Metric
from ev_sim.recording.files_of_run import OF_ALL_RUNS, PAGE, SUMMARY
from ev_sim.recording.outcome import RunFailed
from ev_sim.recording.progress_bar import bar_of_runs
from ev_sim.report.summary import versions, write_summary
from ev_sim.report.table_files import TABLES, write_tables
from ev_sim.report.tables import print_metrics
from ev_sim.running.output_folder import OutputFolder
from ev_sim.study.case import Case, CaseResult
from ev_sim.study.command import arguments, study_cases
from ev_sim.study.kept_rows import NAME, KeptRows, MeasureAndSave
from ev_sim.study.study import Results, Study, study_named
from ev_sim.study.workers import drive_cases


def run_study(name: str, argv: Sequence[str]) -> None:
    """Drive all cases of a study and report; raises what `ev_sim.commands.run_scenario.main` catches."""
    study, given = study_named(name), arguments(name, argv)
    cases = study_cases(study, given)
    out = given.out or Path("results") / name
    rows = KeptRows(out, name, cases, given.anew)
    signals = {case.name: path for case in cases if given.signals and (path := rows.signals_of(case))}
    names = [*OF_ALL_RUNS, *TABLES, NAME, *signals.values()]
    with OutputFolder(out, f"study {name}", names, keeps=rows.files) as folder:
        start = time.monotonic()
        paths = {case: folder.directory / path for case, path in signals.items()}
        driven, before = _drive(name, given, cases, paths, rows)
        wall_time = time.monotonic() - start
        results = {result.name: result for result in driven}
        if all(result.refused for result in driven):
            raise RunFailed(f"none of {len(driven)} runs has a row; {driven[0].name}: {driven[0].refused}")
        metrics, figures, tables, table = _summed_up(study, given, results)
        folder.claim(figure_files(figures, given.figures))
        save_figures(figures, folder.directory, given.figures)
        content = _summary(name, given, cases, signals, results, metrics, wall_time)
        content["command"] = command_of([name, *argv])
        write_summary(folder.directory / SUMMARY, content)
        if table is not None:
            write_tables(folder.directory, *table)
        if not given.no_report:
            from ev_sim.report.page.content import measured_signals
            from ev_sim.report.page.writing import Page, images_of, write_page

            series = measured_signals({case: result.measured for case, result in results.items()})
            shown = Page(name, {"": content}, series, images_of(figures, folder.directory), tables)
            write_page(shown, folder.directory / PAGE)
    if tables:
        print(tables, end="\n\n")
    print_metrics(metrics)
    for reason in dict.fromkeys(result.refused for result in driven if result.refused):
        of = [result for result in driven if result.refused == reason]
        print(f"not {'measured' if of[0].signal_hash else 'driven'}: {', '.join(r.name for r in of)}: {reason}")
    _print_notes(driven)
    print(f"signal hash {content['signal_hash']}")
    again = f", {before} of them driven before (--anew drives them again)" if before else ""
    print(f"{len(cases)} runs, {content['simulated_time']:g} s in {wall_time:.1f} s{again}")
    page = "" if given.no_report else "report.html, "
    print(f"{page}figures and summary: {folder.directory}")


def _drive(
    name: str, given: argparse.Namespace, cases: Sequence[Case], paths: Mapping[str, Path], rows: KeptRows
) -> tuple[list[CaseResult], int]:
    """The results of all cases, in their order, and how many of them were there already.

    `paths` are those of the signals by case, none if they are not kept. RunFailed if one is not there in the end.
    """
    measure = study_named(name).measure
    found = {case.name: result for case in cases if (result := rows.of(case)) is not None}
    found = {key: result for key, result in found.items() if key not in paths or paths[key].exists()}
    missing = {case.name: case for case in cases if case.name not in found}
    with bar_of_runs(name, len(cases), len(found)) as bar:

        def heard(result: CaseResult) -> None:
            rows.keep(missing[result.name], result)
            bar.update()

        measures = [MeasureAndSave(measure, paths[each]) if each in paths else measure for each in missing]
        driven = drive_cases(list(missing.values()), measures, heard, given.scheduler, given.workers) if missing else []
    results = {**found, **{result.name: result for result in driven}}
    for case, result in results.items():
        if case in paths and not result.refused and not paths[case].exists():
            raise RunFailed(f"{case}: its worker has written no {paths[case]}, which --signals needs all to see")
    return [results[case.name] for case in cases], len(found)


def _summed_up(
    study: Study, given: argparse.Namespace, results: Results
) -> tuple[dict[str, Metric], dict[str, Figure], str, Any]:
    """Metrics, figures, tables and, if the study has it, the table for files; RunFailed if a case lacks for them."""
    try:
        metrics, figures = study.metrics(given, results), study.figures(given, results)
        table = study.table(given, results) if hasattr(study, "table") else None
        return metrics, figures, study.tables(given, results), table
    except Exception as error:
        lacking = next((result for result in results.values() if result.refused), None)
        if lacking is None or isinstance(error, ParameterError):
            raise
        raise RunFailed(f"this study needs all of its cases; {lacking.name}: {lacking.refused}") from error


def _print_notes(results: Sequence[CaseResult]) -> None:
    """Each note once, with the first case that has it."""
    cases: dict[str, list[str]] = {}
    for result in results:
        for note in result.notes:
            cases.setdefault(note, []).append(result.name)
    for note, names in cases.items():
        more = f" and {len(names) - 1} more" if len(names) > 1 else ""
        print(f"note: {names[0]}{more}: {shown(note, LINE)}")


def _summary(
    name: str,
    given: argparse.Namespace,
    cases: Sequence[Case],
    signals: Mapping[str, str],
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
                "signals": signals.get(case.name),
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
