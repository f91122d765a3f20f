"""scripts/run.sh verdicts: drive what the verdicts on all published numbers need, and print and write them."""

from __future__ import annotations

import argparse
import shutil
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

from ev_msgs_py.refusal import ParameterError
from ev_sim.command_line.refusal import Parser
from ev_sim.recording.progress_bar import bar_of_runs
from ev_sim.report.tables import WIDTH_OF_A_PIPE
from ev_sim.running.output_folder import OutputFolder
from ev_sim.study.case import Case, CaseResult, Measure
from ev_sim.study.workers import drive_cases
from ev_sim.verdicts.driving import drive, kept_by_user
from ev_sim.verdicts.need import Driven, Need
from ev_sim.verdicts.panels_page import images_by_id
from ev_sim.verdicts.sources import sources
from ev_sim.verdicts.verdict import (
    FILES,
    Verdict,
    counts,
    needs_of,
    plain_table,
    verdicts,
    wanted,
    write,
)


def run_verdicts(argv: Sequence[str]) -> None:
    """Drive, judge, print and write; raises what `ev_sim.commands.run_scenario.main` catches."""
    given = _arguments(argv)
    chosen = wanted(given.only, given.quick)
    if not chosen:
        raise ParameterError(f"--only {' '.join(given.only)}: no such id or source; sources: {', '.join(sources())}")
    start = time.monotonic()
    found, _ = judge_driven(given.only, given.quick)
    with OutputFolder(given.out or Path("results") / "verdicts", "verdicts", FILES) as folder:
        images = {id: names for source in sources() for id, names in images_by_id(source).items()}
        write(found, folder.directory, images)
    print(plain_table(found, shutil.get_terminal_size((WIDTH_OF_A_PIPE, 24)).columns))
    for source in sources():
        of_source = [each for (name, _), each in zip(chosen, found, strict=True) if name == source]
        if of_source:
            print(f"{source}: {counts(of_source)}")
    print(f"all: {counts(found)}")
    print(f"{time.monotonic() - start:.1f} s; table: {folder.directory}")


def judge_driven(only: Sequence[str] = (), quick: bool = False) -> tuple[list[Verdict], Mapping[Need, Driven]]:
    """The verdicts on some sources or ids, all if none is named, and what was driven for them.

    What is not kept yet is driven on all cores.
    """
    chosen = wanted(only, quick)
    driven = drive(needs_of(chosen), kept_by_user(), drive_with_progress)
    return verdicts(chosen, driven), driven


def drive_with_progress(cases: Sequence[Case], measures: Sequence[Measure]) -> list[CaseResult]:
    """Drive cases on all cores of this machine behind a progress bar."""
    with bar_of_runs("driving", len(cases)) as bar:
        return drive_cases(cases, measures, lambda result: bar.update())


def _arguments(argv: Sequence[str]) -> argparse.Namespace:
    parser = Parser(prog="run.sh verdicts", description=__doc__)
    parser.add_argument("--out", type=Path, metavar="DIR", help="output folder; default results/verdicts")
    parser.add_argument("--only", nargs="+", default=[], metavar="SOURCE", help="sources, ids or beginnings of ids")
    parser.add_argument("--quick", action="store_true", help="leave out what takes more than a few seconds to drive")
    return parser.parse_args(argv)
