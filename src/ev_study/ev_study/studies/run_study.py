"""Drive a study from the command line: its cases on workers, then tables, metrics and figures."""

from __future__ import annotations

import argparse
import hashlib
import math
import shutil
import time
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from datetime import timedelta
from pathlib import Path
from typing import Any
from zipfile import is_zipfile

from ev_msgs_py.refusal import LINE, ParameterError, quoted, shown
from ev_stack.command_line.numbers import whole
from ev_stack.command_line.options import (
    add_outputs,
    add_overrides,
    add_traceback,
    command_of,
    files_read,
    overrides,
    printing,
)
from ev_stack.command_line.paths import output_folder
from ev_stack.command_line.refusal import Parser
from ev_stack.figures.saving import figure_files, save_figures
from ev_stack.figures.sheets import Sheet, drawn
from ev_stack.measures.metric import Metric
from ev_stack.recording.outcome import RunFailed, announce, bar_of_runs
from ev_stack.recording.recording import OF_ALL_RUNS, PAGE, SUMMARY
from ev_stack.report.latex import DIGITS
from ev_stack.report.summary import versions, write_summary
from ev_stack.report.tables import TABLES, print_metrics, text_table, write_tables
from ev_stack.running.output_folder import OutputFolder
from ev_stack.scenarios.parameter_file import ParameterFile
from ev_stack.scenarios.scenario import Overrides, refuse_unused_values
from ev_study.studies.digests import digest_of_sources
from ev_study.studies.kept_rows import KeptRows, MeasureAndSave
from ev_study.studies.result_store import RECORDING, ResultStore
from ev_study.studies.study import Case, CaseResult, Results, Study, run_of, study_named
from ev_study.studies.workers import drive_cases, estimated_time

SIGNALS = "signals"  # folder with those of each run, where they are kept
_EVERY_NODE, _FILE = "*", "file"
_NAMED = 5  # cases of one kind, in a line


def arguments(name: str, argv: Sequence[str]) -> argparse.Namespace:
    """Parse the command line of a study; argparse ends the process with status 2 for words it does not know."""
    study = study_named(name)
    parser = Parser(prog=f"run.sh {name}", description=study.ABOUT)
    where = parser.add_mutually_exclusive_group()
    where.add_argument(
        "--scheduler", metavar="tcp://HOST:PORT", help="a dask scheduler instead of this machine"
    )
    where.add_argument(
        "--workers", type=whole(1), metavar="N", help="worker processes here; default: one per core"
    )
    parser.add_argument(
        "--out", type=output_folder, metavar="DIR", help=f"output folder; default results/{name}"
    )
    parser.add_argument("--anew", action="store_true", help="drive again what was driven before")
    parser.add_argument(
        "--signals", action="store_true", help="keep the signals of every run, in DIR/signals"
    )
    add_overrides(parser)
    add_outputs(parser)
    add_traceback(parser)
    parser.add_argument(
        "--digits",
        type=whole(1),
        default=DIGITS,
        metavar="N",
        help="significant ones of table.tex; default: %(default)s",
    )
    parser.add_argument(
        "--bold",
        action="store_true",
        help="best values of table.tex in bold, where one way is better",
    )
    getattr(study, "add_options", lambda parser: None)(parser)
    return parser.parse_args(argv)


def study_cases(study: Study, given: argparse.Namespace) -> list[Case]:
    """The cases of a study with what the command line changes in all of them.

    ParameterError if it sets what a case sets itself, if two cases have one name, or if runs end
    before there is anything to measure.
    """
    common, cases = overrides(given), study.cases(given)
    shortest = getattr(study, "SHORTEST", 0.0)
    if common.duration is not None and 0.0 < common.duration < shortest:
        raise ParameterError(
            f"--duration {common.duration:g} is refused: what this study measures comes later, "
            f"expected {shortest:g} s or more"
        )
    changed, names = _changed(common), set[str]()
    for case in cases:
        if case.name in names:
            raise ParameterError(f"case {quoted(case.name)} is there twice, expected once")
        names.add(case.name)
        _refuse_what_it_sets(case, changed)
        if common.vehicle and case.vehicle:
            raise ParameterError(
                f"--vehicle is refused: case {quoted(case.name)} sets it itself, {case.vehicle}"
            )
    cases = [
        replace(
            case,
            values=(*case.values, *common.all_values),
            files=(*case.files, *common.files),
            duration=case.duration if common.duration is None else common.duration,
            vehicle=common.vehicle or case.vehicle,
        )
        for case in cases
    ]
    _refuse_unused(study, given, cases)
    return cases


def _refuse_unused(study: Study, given: argparse.Namespace, cases: Sequence[Case]) -> None:
    """ParameterError for what the command line sets or varies and no method of any case has."""
    varied = study.variations(given) if hasattr(study, "variations") else {}
    places = [(*name.split(".", 1), None) for name in varied if "." in name]
    named = [*overrides(given).values, *places]
    if not named:
        return
    alike = {
        (c.scenario, c.run, c.files, *(str(v) for v in c.values if v[1] == "method")): c
        for c in cases
    }
    runs = []
    for case in alike.values():
        with suppress(ParameterError):  # a case that cannot be driven comes back as refused
            runs.append(run_of(case))
    if runs:
        refuse_unused_values(named, runs)


def _changed(common: Overrides) -> list[tuple[str, str]]:
    """Node and name of each parameter that goes before those of the cases; a file of parameters only names files so."""
    in_files = (name for file in common.files for name in ParameterFile(file).names())
    files = [(_EVERY_NODE, name) for name in in_files if name.endswith(_FILE)]
    return [*((node, name) for node, name, _ in common.all_values), *files]


def _refuse_what_it_sets(case: Case, changed: Iterable[tuple[str, str]]) -> None:
    """ParameterError for what would silently take the place of what a case sets, and is called by."""
    for node, name in changed:
        for its_node, its_name, _ in case.values:
            # the same parameter, or a file of which that is read: speed_profile.file of
            # speed_profile.time
            is_it = name == its_name or (
                name.endswith(_FILE) and its_name.startswith(name.removesuffix(_FILE))
            )
            if is_it and (node == its_node or _EVERY_NODE in (node, its_node)):
                raise ParameterError(
                    f"{node}.{name} is refused: case {quoted(case.name)} sets {its_node}.{its_name} itself"
                )


def run_study(words: Sequence[str]) -> None:
    """Drive all cases of a study, by its name and the words behind it, and report.

    It raises what `ev_stack.commands.run_scenario.main` catches.
    """
    name, *argv = words
    study, given = study_named(name), arguments(name, argv)
    cases, prints = study_cases(study, given), printing(given)
    out = given.out or Path("results") / name
    announce(f"{name}: {len(cases)} runs")
    store = ResultStore(digest_of_sources())
    rows = KeptRows(store, name, cases)
    keys = {case.name: rows.key_of(case) for case in cases if given.signals}
    signals = {case: f"{SIGNALS}/{key}{RECORDING}" for case, key in keys.items() if key is not None}
    names = [*OF_ALL_RUNS, *TABLES, *signals.values()]
    with OutputFolder(out, f"study {name}", names, reads=files_read(given)) as folder:
        start = time.monotonic()
        kept = {case: store.path(Path(path).name) for case, path in signals.items()}
        driven, before = _drive(name, given, cases, kept, rows)
        for case, path in signals.items():
            (folder.directory / SIGNALS).mkdir(exist_ok=True)
            if kept[case].exists():  # none of a case that is refused
                shutil.copyfile(kept[case], folder.directory / path)
        wall_time = time.monotonic() - start
        results = {result.name: result for result in driven}
        if all(result.refused for result in driven):
            raise RunFailed(
                f"none of {len(driven)} runs has a row; {driven[0].name}: {driven[0].refused}"
            )
        metrics, sheets, tables, table = _summed_up(study, given, results)
        figures = {} if given.no_report else drawn(sheets)
        folder.claim(figure_files(figures))
        save_figures(figures, folder.directory)
        content = _summary(name, given, cases, signals, results, metrics, wall_time)
        content["command"] = command_of([name, *argv])
        write_summary(folder.directory / SUMMARY, content)
        if table is not None:
            best = study.better(given, results) if given.bold and hasattr(study, "better") else {}
            write_tables(folder.directory, *table, given.digits, best)
        if not given.no_report:
            from ev_stack.report.page.writing import Page, images_of, measured_signals, write_page

            measured = {case: result.measured for case, result in results.items()}
            series = measured_signals(
                measured, getattr(study, "CURVES", {}), [each.name for each in driven if each.spun]
            )
            shown = Page(name, {"": content}, series, images_of(figures, folder.directory), tables)
            write_page(shown, folder.directory / PAGE)
        prints.save(sheets, folder.directory, folder.claim)
    if tables:
        print(tables, end="\n\n")
    # What a table has stands there, and not once more below it.
    if (
        shown := metrics
        if table is None
        else {key: each for key, each in metrics.items() if each.reference}
    ):
        print_metrics(shown)
    for reason in dict.fromkeys(result.refused for result in driven if result.refused):
        of = [result for result in driven if result.refused == reason]
        print(
            f"not {'measured' if of[0].signal_hash else 'driven'}: {', '.join(r.name for r in of)}: {reason}"
        )
    if spun := [result.name for result in driven if result.spun]:
        more = f" and {len(spun) - _NAMED} more" if len(spun) > _NAMED else ""
        print(f"spun, by more than 90 deg: {', '.join(spun[:_NAMED])}{more}")
    _print_notes(driven)
    print(f"signal hash {content['signal_hash']}")
    again = f", {before} of them driven before (--anew drives them again)" if before else ""
    print(f"{len(cases)} runs, {content['simulated_time']:g} s in {wall_time:.1f} s{again}")
    page = "" if given.no_report else "report.html, figures and "
    print(f"{page}summary: {folder.directory}")


def _drive(
    name: str,
    given: argparse.Namespace,
    cases: Sequence[Case],
    paths: Mapping[str, Path],
    rows: KeptRows,
) -> tuple[list[CaseResult], int]:
    """The results of all cases, in their order, and how many of them were there already.

    `paths` are those of the signals by case, none if they are not kept. RunFailed if one is not
    there in the end.
    """
    measure = study_named(name).measure
    before = () if given.anew else cases
    found = {case.name: result for case in before if (result := rows.of(case)) is not None}
    found = {
        key: result for key, result in found.items() if key not in paths or is_zipfile(paths[key])
    }
    missing = {case.name: case for case in cases if case.name not in found}
    if missing and given.scheduler is None:
        seconds = timedelta(
            seconds=math.ceil(estimated_time(list(missing.values()), given.workers))
        )
        announce(f"{name}: {len(missing)} of them to drive, in about {seconds}")
    with bar_of_runs(name, len(cases), len(found)) as bar:

        def keep(result: CaseResult) -> None:
            rows.keep(missing[result.name], result)
            bar.update()

        measures = [
            MeasureAndSave(measure, paths[each]) if each in paths else measure for each in missing
        ]
        driven = (
            drive_cases(list(missing.values()), measures, keep, given.scheduler, given.workers)
            if missing
            else []
        )
    results = {**found, **{result.name: result for result in driven}}
    for case, result in results.items():
        if case in paths and not result.refused and not is_zipfile(paths[case]):
            raise RunFailed(
                f"{case}: its worker has written no {paths[case]}, which --signals needs all to see"
            )
    return [results[case.name] for case in cases], len(found)


def _summed_up(
    study: Study, given: argparse.Namespace, results: Results
) -> tuple[dict[str, Metric], dict[str, Sheet], str, Any]:
    """Metrics, figures, tables and, if the study has it, the table for files; RunFailed if a case lacks for them."""
    try:
        figures = figures_of(study, given, results)
        table = study.table(given, results) if hasattr(study, "table") else None
        return study.metrics(given, results), figures, printed(study, given, results), table
    except Exception as error:
        lacking = next((result for result in results.values() if result.refused), None)
        if lacking is None or isinstance(error, ParameterError):
            raise
        raise RunFailed(
            f"this study needs all of its cases; {lacking.name}: {lacking.refused}"
        ) from error


def figures_of(study: Study, given: argparse.Namespace, results: Results) -> dict[str, Sheet]:
    """The figures of a study, none if it draws none."""
    return study.figures(given, results) if hasattr(study, "figures") else {}


def printed(study: Study, given: argparse.Namespace, results: Results) -> str:
    """What a study prints above its metrics, as aligned text; may be empty."""
    if hasattr(study, "tables"):
        return study.tables(given, results)
    table = text_table(
        study.COLUMNS, study.rows(given, results), left=study.COLUMNS[: getattr(study, "LEFT", 1)]
    )
    return f"{study.HEADING}\n{table}" if hasattr(study, "HEADING") else table


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
        "options": {
            key: str(value) for key, value in sorted(vars(given).items()) if value is not None
        },
        "metrics": {key: metric.as_json() for key, metric in metrics.items()},
        "signal_hash": hashlib.sha256(hashes.encode()).hexdigest(),
        "cases": {
            case.name: _entry(case, results[case.name], signals.get(case.name)) for case in cases
        },
        "simulated_time": sum(result.simulated_time for result in results.values()),
        "wall_time": wall_time,
        "versions": versions(),
    }


def _entry(case: Case, result: CaseResult, signals: str | None) -> dict[str, Any]:
    # of which the others are no plain values
    found = {**result.measured, **result.measured.get("metrics", {})}
    plain = {
        key: each
        for key, each in found.items()
        if isinstance(each, str | int | float | bool | None)
    }
    return {
        "scenario": case.scenario,
        "run": case.run,
        "values": [list(value) for value in case.values],
        "signal_hash": result.signal_hash,
        "refused": result.refused,
        "notes": list(result.notes),
        "spun": result.spun,
        "signals": signals,
        "measured": plain,
    }
