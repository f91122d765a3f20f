"""scripts/run.sh figures: draw every panel of the sources in its quantity and axes, on one page."""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from pathlib import Path

from ev_msgs_py.refusal import ParameterError
from ev_sim.command_line.refusal import Parser
from ev_sim.commands.reviews.verdicts import drive_with_progress
from ev_sim.running.output_folder import OutputFolder
from ev_sim.verdicts.driving import drive, kept_by_user
from ev_sim.verdicts.panels_page import INDEX, draw_panels, file_name, panels, write_page
from ev_sim.verdicts.sources import sources


def run_figures(argv: Sequence[str]) -> None:
    """Drive, draw and write; raises what `ev_sim.commands.run_scenario.main` catches."""
    given = _arguments(argv)
    for source in given.only:
        if source not in sources():
            raise ParameterError(f"--only {source} is refused, allowed is {', '.join(sources())}")
    start = time.monotonic()
    shown = {source: panels(source) for source in sources() if not given.only or source in given.only}
    needs = [need for of_source in shown.values() for panel in of_source for need in panel.needs]
    driven = drive(needs, kept_by_user(), drive_with_progress)
    files = [file_name(source, panel) for source, of_source in shown.items() for panel in of_source]
    with OutputFolder(given.out or Path("results") / "figures", "figures", [INDEX, *files]) as folder:
        for source, of_source in shown.items():
            drawn = draw_panels(source, of_source, driven, folder.directory)
            print(f"{source}: {len(of_source)} panels, {len(drawn)} drawn, {len(of_source) - len(drawn)} not drawable")
        page = write_page(shown, folder.directory)
    every = [panel for of_source in shown.values() for panel in of_source]
    drawn_in_all = sum(panel.draw is not None for panel in every)
    print(f"all: {len(every)} panels, {drawn_in_all} drawn, {len(every) - drawn_in_all} not drawable")
    print(f"{time.monotonic() - start:.1f} s; page: {page}")


def _arguments(argv: Sequence[str]) -> argparse.Namespace:
    parser = Parser(prog="run.sh figures", description=__doc__)
    parser.add_argument("--out", type=Path, metavar="DIR", help="output folder; default results/figures")
    parser.add_argument("--only", nargs="+", default=[], metavar="SOURCE", help="sources")
    return parser.parse_args(argv)
