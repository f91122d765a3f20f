"""Commands about what the sources published: verdicts on all numbers, and every panel of their figures.

Each raises what `ev_stack.commands.run_scenario.main` catches.
"""

from __future__ import annotations

import shutil
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

from ev_msgs_py.refusal import ParameterError, quoted
from ev_stack.command_line.paths import add_out
from ev_stack.command_line.refusal import Parser
from ev_stack.recording.recording import atomic_file
from ev_stack.report.tables import WIDTH_OF_A_PIPE
from ev_stack.running.output_folder import output_folder
from ev_study.measured.comparisons.comparison import FILE as COMPARISONS
from ev_study.measured.comparisons.comparison import compare, kept_text
from ev_study.measured.comparisons.comparison import table as comparison_table
from ev_study.studies.driving import drive_cases
from ev_study.verdicts.need import Driven, Need, drive, kept_by_user
from ev_study.verdicts.panels_page import (
    PublishedPanel,
    draw_panels,
    images_by_id,
    panels,
)
from ev_study.verdicts.panels_page import write_page as write_panels
from ev_study.verdicts.sources import published, sources
from ev_study.verdicts.verdict import (
    Verdict,
    counts,
    failures,
    plain_table,
    verdict,
    wanted,
    write,
)

MEASURED = "measured"  # among the sources of `verdicts`, with --data


def _parser(name: str, about: str) -> Parser:
    parser = Parser(prog=f"run.sh {name}", description=f"scripts/run.sh {name}: {about}")
    add_out(parser, name)
    return parser


def run_verdicts(argv: Sequence[str]) -> None:
    """Drive, judge, print and write."""
    parser = _parser(
        "verdicts",
        "drive what the verdicts on all published numbers need, and print and write them.",
    )
    parser.add_argument(
        "--only",
        nargs="+",
        action="extend",
        default=[],
        metavar="SOURCE",
        help="sources, ids or beginnings of ids",
    )
    parser.add_argument(
        "--quick", action="store_true", help="leave out what takes more than a few seconds to drive"
    )
    parser.add_argument(
        "--data",
        type=Path,
        metavar="DIR",
        help=(
            f"folder of measured data to hold the car against as well; --only {MEASURED} alone"
            " (docs/measured.md)"
        ),
    )
    given = parser.parse_args(argv)
    start = time.monotonic()
    # With --data it is no source of published numbers; without, it is refused as an unknown one.
    only = [name for name in given.only if name != MEASURED or given.data is None]
    if given.data is not None and given.only and MEASURED not in given.only:
        chosen = f"--only {' '.join(only)}"
        raise ParameterError(f"--data is refused beside {chosen}, expected {MEASURED} there, too")
    for word in only:
        if not wanted([word], quick=False):
            raise ParameterError(
                f"--only {quoted(word)}: no such id or source; sources: {', '.join(sources())}"
            )
    if only and not wanted(only, given.quick):
        raise ParameterError(f"--quick leaves nothing of --only {' '.join(only)}")
    with output_folder(given.out, "verdicts") as folder:
        # With `--only measured` alone nothing of the papers is driven.
        found = judge_driven(only, given.quick)[0] if only or not given.only else []
        if found:
            images = {
                id: names for source in sources() for id, names in images_by_id(source).items()
            }
            write(found, folder, images)
        if given.data is not None and (MEASURED in given.only or not given.only):
            compared = compare(given.data, lambda line: print(line, flush=True))
            with atomic_file(folder / COMPARISONS) as file:
                file.write(kept_text(compared).encode())
            print(comparison_table(compared))
    if found:
        print(plain_table(found, shutil.get_terminal_size((WIDTH_OF_A_PIPE, 24)).columns))
        print(failures(found))
        for source in sources():
            if of_source := [each for each in found if each.published.id in published(source)]:
                print(f"{source}: {counts(of_source)}")
        print(f"all: {counts(found)}")
    print(f"{time.monotonic() - start:.1f} s; table: {folder}")


def judge_driven(
    only: Sequence[str] = (), quick: bool = False
) -> tuple[list[Verdict], Mapping[Need, Driven]]:
    """The verdicts on some sources or ids, all if none is named, and what was driven for them.

    What is not kept yet is driven on all cores.
    """
    chosen = [each for _, each in wanted(only, quick)]
    # All needs at once: one that several ids have is driven once, and all cores are busy.
    driven = drive([need for each in chosen for need in each.needs], kept_by_user(), drive_cases)
    return [verdict(each, [driven[need] for need in each.needs]) for each in chosen], driven


def run_figures(argv: Sequence[str]) -> None:
    """Drive, draw and write."""
    parser = _parser("figures", "draw every panel of the sources, on one page.")
    parser.add_argument(
        "--only", nargs="+", action="extend", default=[], metavar="SOURCE", help="sources"
    )
    given = parser.parse_args(argv)
    for source in given.only:
        if source not in sources():
            known = ", ".join(sources())
            raise ParameterError(f"--only {quoted(source)} is refused, expected {known}")
    start = time.monotonic()
    shown = {
        source: panels(source) for source in sources() if not given.only or source in given.only
    }
    every = [(source, panel) for source, of_source in shown.items() for panel in of_source]
    with output_folder(given.out, "figures") as folder:
        needs = [need for _, panel in every for need in panel.needs]
        driven = drive(needs, kept_by_user(), drive_cases)
        for source, of_source in shown.items():
            draw_panels(source, of_source, driven, folder)
            print(f"{source}: {_counts(of_source)}")
        page = write_panels(shown, folder)
    print(f"all: {_counts([panel for _, panel in every])}")
    print(f"{time.monotonic() - start:.1f} s; page: {page}")


def _counts(of: Sequence[PublishedPanel]) -> str:
    drawn = sum(panel.draw is not None for panel in of)
    return f"{len(of)} panels, {drawn} drawn, {len(of) - drawn} not drawable"
