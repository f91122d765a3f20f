"""Commands about runs that were driven, and about what the sources published: scripts/run.sh NAME.

Each raises what `ev_sim.commands.run_scenario.main` catches.
"""

from __future__ import annotations

import json
import shlex
import shutil
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ev_core.lockstep.finding import LIBRARIES, is_code
from ev_core.methods.register import methods_of
from ev_core.parameters.data_file import TABLE, read_data
from ev_core.parameters.values import build
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.refusal import ParameterError, quoted
from ev_sim.command_line.options import add_changes, add_outputs, command_of, overrides, printing
from ev_sim.command_line.paths import output_folder
from ev_sim.command_line.refusal import Parser
from ev_sim.measured.comparisons.comparison import FILE as COMPARISONS
from ev_sim.measured.comparisons.comparison import compare, kept_text
from ev_sim.measured.comparisons.comparison import table as comparison_table
from ev_sim.recording.outcome import Outcome, bar_of_runs, progress_bar
from ev_sim.recording.recording import PAGE, SIGNALS, SUMMARY, atomic_file, load
from ev_sim.replay.graph import Replay, Replayed, prepared, replay_folder, replay_of
from ev_sim.replay.recorded import find_recorded
from ev_sim.report.page.writing import Page, Signals, write_page
from ev_sim.report.tables import WIDTH_OF_A_PIPE
from ev_sim.running.beforehand import compile_for
from ev_sim.running.folder_content import stays_within
from ev_sim.running.offline import run_offline_into
from ev_sim.running.output_folder import OutputFolder
from ev_sim.scenarios.scenario import Run
from ev_sim.study.study import Case, CaseResult, Measure
from ev_sim.study.workers import drive_cases
from ev_sim.verdicts.need import Driven, Need, drive, kept_by_user
from ev_sim.verdicts.panels_page import INDEX, PublishedPanel, draw_panels, file_name, images_by_id, panels
from ev_sim.verdicts.panels_page import write_page as write_panels
from ev_sim.verdicts.sources import published, sources
from ev_sim.verdicts.verdict import FILES, Verdict, counts, plain_table, verdict, wanted, write

MEASURED = "measured"  # among the sources of `verdicts`, with --data


def _parser(name: str, about: str) -> Parser:
    parser = Parser(prog=f"run.sh {name}", description=f"scripts/run.sh {name}: {about}")
    folder = Path("results") / name
    parser.add_argument(
        "--out", type=output_folder, metavar="DIR", default=folder, help=f"output folder; default {folder}"
    )
    return parser


def run_verdicts(argv: Sequence[str]) -> None:
    """Drive, judge, print and write."""
    parser = _parser("verdicts", "drive what the verdicts on all published numbers need, and print and write them.")
    parser.add_argument(
        "--only", nargs="+", action="extend", default=[], metavar="SOURCE", help="sources, ids or beginnings of ids"
    )
    parser.add_argument("--quick", action="store_true", help="leave out what takes more than a few seconds to drive")
    parser.add_argument(
        "--data",
        type=Path,
        metavar="DIR",
        help=f"folder of measured data to hold the car against as well; --only {MEASURED} alone (docs/measured.md)",
    )
    given = parser.parse_args(argv)
    start = time.monotonic()
    only = [name for name in given.only if name != MEASURED or given.data is None]
    found = judge_driven(only, given.quick)[0] if only or not given.only else []
    if only and not found:
        raise ParameterError(f"--only {' '.join(given.only)}: no such id or source; sources: {', '.join(sources())}")
    with OutputFolder(given.out, "verdicts", (*FILES, COMPARISONS)) as folder:
        if found:
            images = {id: names for source in sources() for id, names in images_by_id(source).items()}
            write(found, folder.directory, images)
        if given.data is not None and (MEASURED in given.only or not given.only):
            compared = compare(given.data, lambda line: print(line, flush=True))
            with atomic_file(folder.directory / COMPARISONS) as file:
                file.write(kept_text(compared).encode())
            print(comparison_table(compared))
    if found:
        print(plain_table(found, shutil.get_terminal_size((WIDTH_OF_A_PIPE, 24)).columns))
        for source in sources():
            if of_source := [each for each in found if each.published.id in published(source)]:
                print(f"{source}: {counts(of_source)}")
        print(f"all: {counts(found)}")
    print(f"{time.monotonic() - start:.1f} s; table: {folder.directory}")


def judge_driven(only: Sequence[str] = (), quick: bool = False) -> tuple[list[Verdict], Mapping[Need, Driven]]:
    """The verdicts on some sources or ids, all if none is named, and what was driven for them.

    What is not kept yet is driven on all cores.
    """
    chosen = [each for _, each in wanted(only, quick)]
    driven = drive([need for each in chosen for need in each.needs], kept_by_user(), drive_with_progress)
    return [verdict(each, [driven[need] for need in each.needs]) for each in chosen], driven


def drive_with_progress(cases: Sequence[Case], measures: Sequence[Measure]) -> list[CaseResult]:
    """Drive cases on all cores of this machine behind a progress bar."""
    with bar_of_runs("driving", len(cases)) as bar:
        return drive_cases(cases, measures, lambda result: bar.update())


def run_figures(argv: Sequence[str]) -> None:
    """Drive, draw and write."""
    parser = _parser("figures", "draw every panel of the sources, on one page.")
    parser.add_argument("--only", nargs="+", action="extend", default=[], metavar="SOURCE", help="sources")
    given = parser.parse_args(argv)
    for source in given.only:
        if source not in sources():
            raise ParameterError(f"--only {source} is refused, expected {', '.join(sources())}")
    start = time.monotonic()
    shown = {source: panels(source) for source in sources() if not given.only or source in given.only}
    every = [(source, panel) for source, of_source in shown.items() for panel in of_source]
    driven = drive([need for _, panel in every for need in panel.needs], kept_by_user(), drive_with_progress)
    files = [file_name(source, panel) for source, panel in every]
    with OutputFolder(given.out, "figures", [INDEX, *files]) as folder:
        for source, of_source in shown.items():
            draw_panels(source, of_source, driven, folder.directory)
            print(f"{source}: {_counts(of_source)}")
        page = write_panels(shown, folder.directory)
    print(f"all: {_counts([panel for _, panel in every])}")
    print(f"{time.monotonic() - start:.1f} s; page: {page}")


def _counts(of: Sequence[PublishedPanel]) -> str:
    drawn = sum(panel.draw is not None for panel in of)
    return f"{len(of)} panels, {drawn} drawn, {len(of) - drawn} not drawable"


def run_replay(argv: Sequence[str]) -> None:
    """Replay one role of a recorded run, and print and write what differs."""
    parser = _parser("replay", "recorded inputs into a law or a node, its answers beside the recorded ones.")
    parser.add_argument("bag", type=Path, metavar="BAG", help="a bag, the folder of a run, or its signals.npz")
    parser.add_argument(
        "--node",
        required=True,
        metavar="NODE[=METHOD_OR_COMMAND]",
        help="what is played anew: by the recorded method, by another one, or by your own node",
    )
    parser.add_argument("--namespace", default="", metavar="NS", help="that of the topics, if a bag has several")
    add_changes(parser)
    add_outputs(parser)
    given = parser.parse_args(argv)
    prints = printing(given)
    role, _, text = given.node.partition("=")
    recorded = find_recorded(given.bag, given.namespace)
    method, command = _meant(role, text)
    replay = replay_of(recorded, role, method, overrides(given))
    with replay_folder(replay, given.out) as folders:
        run = prepared(replay, folders)
        outcome = _play(replay, run, folders.of(run), command)
        found = replay.differences(outcome.recording)
        replayed = Replayed(replay, run, outcome, found, command, command_of(["replay", *argv]))
        print("\n".join(replayed.lines()))
        page = replayed.write(folders, not given.no_report, prints)
    print(f"{page}table, signals and summary: {folders.directory}")


def _meant(role: str, text: str) -> tuple[str, list[str]]:
    """The method or the words of the command that stands behind NODE=; ParameterError if it is neither."""
    known = methods_of(role)
    if not text or text in known or text.endswith(LIBRARIES):
        return text, []
    try:
        words = shlex.split(text)
    except ValueError as error:
        raise ParameterError(f"--node {quoted(text)} is refused: {error}") from None
    if not words or shutil.which(words[0]) is None:
        if is_code(text):
            return text, []
        methods = f"a method ({', '.join(known)})" if known else "a method"
        raise ParameterError(f"--node {role}={text} is refused, expected {methods}, a library, law file or program")
    return "", words


def _play(replay: Replay, run: Run, folder: Path, command: list[str]) -> Outcome:
    compile_for([run], bool(command), [replay.role] if command else ())
    with progress_bar(f"replay of {replay.role}", run.duration) as progress:
        if not command:
            return run_offline_into(run, folder, False, progress)
        from ev_sim.running.processes import run_in_processes

        return run_in_processes(run, folder, False, progress, {replay.role: command})


def run_report(argv: Sequence[str]) -> None:
    """Read the folders and write the page; ParameterError if one of them was not left behind by a scenario."""
    about = "one page about what several commands left behind, runs and metrics side by side."
    parser = Parser(prog="run.sh report", description=f"scripts/run.sh report: {about}")
    parser.add_argument("folders", nargs="+", type=Path, metavar="DIR", help="what --out of a scenario was")
    parser.add_argument("--out", type=Path, metavar="FILE", help=f"the page; default results/{PAGE}")
    given = parser.parse_args(argv)
    labels = [folder.resolve().name for folder in given.folders]
    if len(set(labels)) < len(labels):
        labels = [str(folder) for folder in given.folders]
    summaries, signals = zip(*map(read_folder, labels, given.folders), strict=True)
    page = given.out or Path("results") / PAGE
    with OutputFolder(page.parent, f"report {page.name}", [page.name]):
        write_page(Page(" and ".join(labels), dict(zip(labels, summaries, strict=True)), signals), page)
    print(f"page: {page.absolute()}")


def read_folder(label: str, folder: Path) -> tuple[Mapping[str, Any], Signals]:
    """The summary of a scenario's folder and its signals; ParameterError that names the folder if one is not whole."""
    try:
        summary: dict[str, Any] = json.loads(read_data(folder / SUMMARY, TABLE))
    except (OSError, ValueError, RecursionError) as error:
        raise ParameterError(f"{folder}: summary.json cannot be read: {error}") from None
    if not isinstance(summary, dict) or "scenario" not in summary:
        raise ParameterError(f"{folder} is that of a study, which keeps no signals; expected that of a scenario")
    try:
        return summary, _signals(label, folder, summary)
    except (LookupError, TypeError, AttributeError, ParameterError) as error:
        raise ParameterError(f"{folder}: summary.json does not say what a run does: {error}") from None
    except (OSError, ValueError) as error:
        raise ParameterError(f"{folder}: signals cannot be read: {error}") from None


def _signals(label: str, folder: Path, summary: Mapping[str, Any]) -> Signals:
    names = list(summary["runs"])
    if outside := [name for name in names if not stays_within(name)]:
        raise ParameterError(f"run {quoted(outside[0])} is refused, expected the name of a folder there")
    runs = {name: load((folder if len(names) == 1 else folder / name) / SIGNALS) for name in names}
    return Signals(label, runs, build(Vehicle, summary["vehicle"]))
