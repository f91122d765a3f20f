"""The command scripts/run.sh report: one page about the folders of several runs.

It raises what `ev_stack.commands.run_scenario.main` catches.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ev_core.parameters.data_file import TABLE, read_data
from ev_core.parameters.values import build
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.refusal import ParameterError, quoted
from ev_stack.command_line.paths import output_path
from ev_stack.command_line.refusal import Parser
from ev_stack.recording.recording import PAGE, SIGNALS, SUMMARY, load
from ev_stack.report.page.writing import Page, Signals, write_page
from ev_stack.running.output_folder import new_file, output_folder


def run_report(argv: Sequence[str]) -> None:
    """Read the folders and write the page.

    Raises ParameterError if one of them was not left behind by a scenario.
    """
    about = "one page about what several commands left behind, runs and metrics side by side."
    parser = Parser(prog="run.sh report", description=f"scripts/run.sh report: {about}")
    parser.add_argument(
        "folders", nargs="+", type=Path, metavar="DIR", help="what --out of a scenario was"
    )
    parser.add_argument(
        "--out",
        type=output_path,
        metavar="FILE",
        help=f"the page; default results/report/latest/{PAGE}",
    )
    given = parser.parse_args(argv)
    labels = [folder.absolute().name for folder in given.folders]
    # Folders of the same name in different places: then whole paths tell them apart.
    if len(set(labels)) < len(labels):
        labels = [str(folder) for folder in given.folders]
    summaries, signals = zip(*map(read_folder, labels, given.folders), strict=True)
    page = Page(" and ".join(labels), dict(zip(labels, summaries, strict=True)), signals)
    if given.out:
        path = new_file(given.out)
        write_page(page, path)
    else:
        with output_folder(None, "report") as folder:
            path = folder / PAGE
            write_page(page, path)
    print(f"page: {path.absolute()}")


def read_folder(label: str, folder: Path) -> tuple[Mapping[str, Any], Signals]:
    """The summary of a scenario's folder and its signals.

    Raises ParameterError that names the folder if one is not whole.
    """
    try:
        summary: dict[str, Any] = json.loads(read_data(folder / SUMMARY, TABLE))
    except (OSError, ValueError, RecursionError) as error:
        raise ParameterError(f"{folder}: summary.json cannot be read: {error}") from None
    if not isinstance(summary, dict) or "scenario" not in summary:
        raise ParameterError(
            f"{folder} is that of a study, which keeps no signals; expected that of a scenario"
        )
    try:
        return summary, _signals(label, folder, summary)
    except (LookupError, TypeError, AttributeError, ParameterError) as error:
        raise ParameterError(
            f"{folder}: summary.json does not say what a run does: {error}"
        ) from None
    except (OSError, ValueError) as error:
        raise ParameterError(f"{folder}: signals cannot be read: {error}") from None


def _signals(label: str, folder: Path, summary: Mapping[str, Any]) -> Signals:
    names = list(summary["runs"])
    for name in names:
        if name in ("", "..") or Path(name).name != name:
            raise ParameterError(f"run {quoted(name)} is refused, expected the name of a folder")
    runs = {name: load((folder if len(names) == 1 else folder / name) / SIGNALS) for name in names}
    # Summaries of former versions name no curves.
    curves = tuple(map(str, summary.get("curves", ())))
    return Signals(label, runs, build(Vehicle, summary["vehicle"]), curves=curves)
