"""Drive a study from the command line: its cases on workers, then tables, metrics and figures.

How it works: the cases of a study get what the command line changes; those with rows in the store
are taken, the others driven, and each row is kept as it comes. Then the study sums all of them up,
and table, summary, figures and page are written into a new folder.
"""

from __future__ import annotations

import argparse
import hashlib
import math
import re
import shutil
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import timedelta
from pathlib import Path
from typing import Any, NoReturn
from zipfile import is_zipfile

from ev_msgs_py.refusal import LINE, ParameterError, quoted, shown
from ev_stack.command_line.numbers import whole
from ev_stack.command_line.options import (
    add_outputs,
    add_overrides,
    command_of,
    overrides,
    printing,
)
from ev_stack.command_line.refusal import Parser
from ev_stack.figures.saving import save_figures
from ev_stack.figures.sheets import Sheet, drawn
from ev_stack.measures.metric import Metric
from ev_stack.recording.outcome import RunFailed, announce
from ev_stack.recording.recording import PAGE, SUMMARY
from ev_stack.report.latex import DIGITS
from ev_stack.report.summary import versions, write_summary
from ev_stack.report.tables import Table, print_metrics, write_tables
from ev_stack.running.output_folder import output_folder
from ev_stack.scenarios.parameter_file import ParameterFile
from ev_stack.scenarios.records import Overrides
from ev_stack.scenarios.unused import refuse_unused_values
from ev_study.studies.digests import digest_of_sources
from ev_study.studies.driving import drive_cases, estimated_time, run_of_each_kind
from ev_study.studies.kept_rows import KeptRows, MeasureAndSave, keys_of_cases
from ev_study.studies.options import add_driving, once_more, workers_of
from ev_study.studies.result_store import RECORDING, ResultStore
from ev_study.studies.study import Case, CaseResult, Results, Study, study_named

SIGNALS = "signals"  # folder with those of each run, where they are kept
_EVERY_NODE, _FILE = "*", "file"
_NAMED = 5  # cases of one kind, in a line


class _Program(Parser):
    """Words that a program gives: what is wrong with them does not end it."""

    def error(self, message: str) -> NoReturn:
        """ParameterError with the line."""
        raise ParameterError(message)


def arguments(name: str, argv: Sequence[str], kind: type[Parser] = Parser) -> argparse.Namespace:
    """Parse the command line of a study; argparse ends the process for words it does not know."""
    study = study_named(name)
    parser = kind(prog=f"run.sh {name}", description=study.ABOUT)
    add_driving(parser, name)
    parser.add_argument(
        "--signals", action="store_true", help="keep the signals of every run, in DIR/signals"
    )
    add_overrides(parser)
    add_outputs(parser)
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
    if hasattr(study, "add_options"):
        study.add_options(parser)
    return parser.parse_args(argv)


def study_cases(study: Study, given: argparse.Namespace) -> list[Case]:
    """Return the cases of a study with what the command line changes in all of them.

    ParameterError if it sets what a case sets itself, if two cases have one name, or if runs end
    before there is anything to measure.
    """
    common = overrides(given)
    cases = study.cases(given)
    shortest = getattr(study, "SHORTEST", 0.0)
    if common.duration is not None and 0.0 < common.duration < shortest:
        raise ParameterError(
            f"--duration {common.duration:g} is refused: what this study measures comes later, "
            f"expected {shortest:g} s or more"
        )
    # What the command line changes is refused where a case sets it: it would undo the study.
    changed = _changed(common)
    names = set[str]()
    for case in cases:
        if case.name in names:
            raise ParameterError(f"case {quoted(case.name)} is there twice, expected once")
        names.add(case.name)
        _refuse_what_it_sets(case, changed)
        if common.vehicle and case.vehicle:
            sets = f"case {quoted(case.name)} sets it itself, {case.vehicle}"
            raise ParameterError(f"--vehicle is refused: {sets}")
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
    # A name without a dot, such as `seed`, is that of no node.
    places = [(*name.split(".", 1), None) for name in varied if "." in name]
    named = [*overrides(given).values, *places]
    # Without options there is nothing to check, and no run to make for it.
    if not named:
        return
    runs = run_of_each_kind(cases)
    if runs:
        refuse_unused_values(named, runs)


def _changed(common: Overrides) -> list[tuple[str, str]]:
    """Return node and name of each parameter that goes before those of the cases.

    Of a parameter file these are only the names of further files.
    """
    found = [(node, name) for node, name, _ in common.all_values]
    for file in common.files:
        for name in ParameterFile(file).names():
            if name.endswith(_FILE):
                found.append((_EVERY_NODE, name))
    return found


def _refuse_what_it_sets(case: Case, changed: Iterable[tuple[str, str]]) -> None:
    """ParameterError for what would silently take the place of what a case sets."""
    for node, name in changed:
        for its_node, its_name, _ in case.values:
            # A file gives the parameters beside it, too: speed_profile.file speed_profile.time.
            gives = name.endswith(_FILE) and its_name.startswith(name.removesuffix(_FILE))
            is_its_node = node == its_node or _EVERY_NODE in (node, its_node)
            if is_its_node and (name == its_name or gives):
                sets = f"case {quoted(case.name)} sets {its_node}.{its_name} itself"
                raise ParameterError(f"{node}.{name} is refused: {sets}")


def run_study(words: Sequence[str]) -> None:
    """Drive all cases of a study, by its name and the words behind it, and report.

    It raises what `ev_stack.commands.run_scenario.main` catches.
    """
    name, *argv = words
    study = study_named(name)
    given = arguments(name, argv)
    cases = study_cases(study, given)
    prints = printing(given)
    announce(f"{name}: {len(cases)} runs")
    # By the sources as they are now: an edit of ours drives all cases anew.
    store = ResultStore(digest_of_sources())
    keys = keys_of_cases(name, cases)
    signals = {}
    if given.signals:
        signals = {case: f"{SIGNALS}/{key.digest}{RECORDING}" for case, key in keys.items()}
    kept = {case: store.path(Path(path).name) for case, path in signals.items()}
    # From here on it takes time: what a command line may have wrong was refused above.
    with output_folder(given.out, name) as folder:
        start = time.monotonic()
        rows = KeptRows(store, CaseResult, keys, given.anew)
        results, before = _drive(name, given, cases, kept, rows)
        if signals:
            (folder / SIGNALS).mkdir()
        for case, path in signals.items():
            # Copied, not moved: the store has them for the next command.
            if kept[case].exists():  # none of a case that is refused
                shutil.copyfile(kept[case], folder / path)
        wall_time = time.monotonic() - start
        found = _summed_up(study, given, results)
        content = {
            **_summary(name, given, cases, results, found.metrics),
            "wall_time": wall_time,
            "command": command_of([name, *argv]),
        }
        for case, path in signals.items():
            content["cases"][case]["signals"] = path
        _write(folder, study, given, results, found, content)
        prints.save(found.sheets, folder)
    _print(found, results.values())
    print(f"signal hash {content['signal_hash']}")
    driven = f"{len(cases)} runs, {content['simulated_time']:g} s in {wall_time:.1f} s"
    print(f"{driven}{once_more(before)}")
    page = "" if given.no_report else "report.html, figures and "
    print(f"{page}summary: {folder}")


def drive_study(name: str, words: Sequence[str]) -> tuple[dict[str, CaseResult], SummedUp]:
    """Drive all cases of a study for a program: what they gave, and what the study makes of it.

    It raises what `run_study` does, and writes nothing but rows into the store.
    """
    study = study_named(name)
    given = arguments(name, words, _Program)
    cases = study_cases(study, given)
    keys = keys_of_cases(name, cases)
    rows = KeptRows(ResultStore(digest_of_sources()), CaseResult, keys)
    results, _ = _drive(name, given, cases, {}, rows)
    return results, _summed_up(study, given, results)


def hash_of(results: Iterable[CaseResult]) -> str:
    """A hash over all signals of a study: in the order of the cases, with their names."""
    hashes = "".join(f"{result.name}\0{result.signal_hash}\n" for result in results)
    return hashlib.sha256(hashes.encode()).hexdigest()


def _drive(
    name: str,
    given: argparse.Namespace,
    cases: Sequence[Case],
    paths: Mapping[str, Path],
    rows: KeptRows[CaseResult],
) -> tuple[dict[str, CaseResult], int]:
    """Return the results of all cases, and how many of them were there already.

    `paths` are those of the signals by case, none if they are not kept. RunFailed if one is not
    there in the end, or if no case has a row.
    """
    found = {}
    for case in cases:
        result = rows.get(case.name)
        # A row without its signals is driven again; a file that was cut off is no zip archive.
        if result and (case.name not in paths or is_zipfile(paths[case.name])):
            found[case.name] = replace(result, name=case.name)
    before = len(found)
    missing = [case for case in cases if case.name not in found]
    workers = workers_of(given)
    # How fast workers elsewhere are is not known here.
    if missing and workers.scheduler is None:
        seconds = timedelta(seconds=math.ceil(estimated_time(missing, workers)))
        announce(f"{name}: {len(missing)} of them to drive, in about {seconds}")

    def keep(_: int, result: CaseResult) -> None:
        if not result.refused:
            rows.keep(result.name, result)

    measure = study_named(name).measure
    measures = []
    for case in missing:
        path = paths.get(case.name)
        measures.append(MeasureAndSave(measure, path) if path else measure)
    for result in drive_cases(missing, measures, keep, workers, (name, before)):
        found[result.name] = result
    for case, path in paths.items():
        if not found[case].refused and not is_zipfile(path):
            lacking = f"its worker has written no {path}, which --signals needs all to see"
            raise RunFailed(f"{case}: {lacking}")
    results = {case.name: found[case.name] for case in cases}
    if all(result.refused for result in results.values()):
        first = results[cases[0].name]
        none = f"none of {len(results)} runs has a row"
        raise RunFailed(f"{none}; {first.name}: {first.refused}")
    return results, before


@dataclass(frozen=True)
class SummedUp:
    """Summary of a study's rows: metrics, figures, text, and a table for files."""

    metrics: dict[str, Metric]
    sheets: dict[str, Sheet]
    text: str
    table: Table | None


def _summed_up(study: Study, given: argparse.Namespace, results: Results) -> SummedUp:
    """Sum results up; RunFailed if a case lacks that the study needs for it."""
    try:
        return SummedUp(
            metrics=study.metrics(given, results),
            sheets=figures_of(study, given, results),
            text=printed(study, given, results),
            table=study.table(given, results) if hasattr(study, "table") else None,
        )
    except Exception as error:
        # The error of a complete study is its own; only one with a gap is explained by it.
        lacking = next((result for result in results.values() if result.refused), None)
        if lacking is None or isinstance(error, ParameterError):
            raise
        needs = "this study needs all of its cases"
        raise RunFailed(f"{needs}; {lacking.name}: {lacking.refused}") from error


def figures_of(study: Study, given: argparse.Namespace, results: Results) -> dict[str, Sheet]:
    """Return the figures of a study, none if it draws none."""
    return study.figures(given, results) if hasattr(study, "figures") else {}


def printed(study: Study, given: argparse.Namespace, results: Results) -> str:
    """Return what a study prints above its metrics, as aligned text; may be empty."""
    if hasattr(study, "tables"):
        return study.tables(given, results)
    left = getattr(study, "LEFT", 1)
    text = Table(study.COLUMNS, study.rows(given, results), left).text()
    return f"{study.HEADING}\n{text}" if hasattr(study, "HEADING") else text


def _write(
    folder: Path,
    study: Study,
    given: argparse.Namespace,
    results: Results,
    found: SummedUp,
    content: Mapping[str, Any],
) -> None:
    """Write figures, summary, table and page."""
    figures = {} if given.no_report else drawn(found.sheets)
    save_figures(figures, folder)
    write_summary(folder / SUMMARY, content)
    if found.table is not None:
        table = found.table
        best = table.better if given.bold else {}
        write_tables(folder, table.columns, table.rows, given.digits, best)
    if given.no_report:
        return
    from ev_stack.report.page.writing import Page, images_of, measured_signals, write_page

    measured = {case: result.measured for case, result in results.items()}
    spun = [case for case, result in results.items() if result.spun]
    units, curves = getattr(study, "CURVES", {}), getattr(study, "FIRST_CURVES", ())
    series = measured_signals(measured, units, spun, curves)
    images = images_of(figures, folder)
    page = Page(content["study"], {"": content}, series, images, found.text)
    write_page(page, folder / PAGE)


def _print(found: SummedUp, results: Iterable[CaseResult]) -> None:
    """Print table and metrics, and what is to be noted about some cases."""
    results = list(results)
    if found.text:
        print(found.text, end="\n\n")
    metrics = found.metrics
    if found.table is not None:
        # What the table has is not printed once more below it, unless it is judged.
        metrics = {name: each for name, each in metrics.items() if each.reference}
    if metrics:
        print_metrics(metrics)
    for reason in dict.fromkeys(result.refused for result in results if result.refused):
        of = [result for result in results if result.refused == reason]
        what = "measured" if of[0].signal_hash else "driven"
        print(f"not {what}: {', '.join(result.name for result in of)}: {reason}")
    if spun := [result.name for result in results if result.spun]:
        more = f" and {len(spun) - _NAMED} more" if len(spun) > _NAMED else ""
        print(f"spun, by more than 90 deg: {', '.join(spun[:_NAMED])}{more}")
    _print_notes(results)


def _print_notes(results: Sequence[CaseResult]) -> None:
    """Print each note once, with the first case that has it, whatever its numbers are."""
    cases: dict[str, list[tuple[str, str]]] = {}
    for result in results:
        for note in result.notes:
            cases.setdefault(re.sub(r"[\d.]+", "", note), []).append((result.name, note))
    for noted in cases.values():
        name, note = noted[0]
        more = f" and {len(noted) - 1} more" if len(noted) > 1 else ""
        print(f"note: {name}{more}: {shown(note, LINE)}")


def _summary(
    name: str,
    given: argparse.Namespace,
    cases: Sequence[Case],
    results: Results,
    metrics: Mapping[str, Metric],
) -> dict[str, Any]:
    """Return the content of summary.json without arrays, which are for figures."""
    options = {key: str(value) for key, value in sorted(vars(given).items()) if value is not None}
    return {
        "study": name,
        "about": study_named(name).ABOUT,
        "options": options,
        "metrics": {key: metric.as_json() for key, metric in metrics.items()},
        "signal_hash": hash_of(results.values()),
        "cases": {case.name: _entry(case, results[case.name]) for case in cases},
        "simulated_time": sum(result.simulated_time for result in results.values()),
        "versions": versions(),
    }


def _entry(case: Case, result: CaseResult) -> dict[str, Any]:
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
        "signals": None,
        "measured": plain,
    }
