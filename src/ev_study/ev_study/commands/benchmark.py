"""The command scripts/run.sh benchmark: laws ranked on a board (docs/benchmark.md).

It raises what `ev_stack.commands.run_scenario.main` catches.
"""

from __future__ import annotations

import argparse
import hashlib
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from ev_core.lockstep.finding import is_code
from ev_core.parameters.data_file import TEXT, read_data
from ev_msgs_py.refusal import ParameterError, quoted, unknown_name
from ev_stack.command_line.options import add_traceback, arguments, command_of
from ev_stack.command_line.paths import output_folder
from ev_stack.command_line.refusal import Parser
from ev_stack.commands.drive_scenario import drive_scenario
from ev_stack.figures.saving import save_figures
from ev_stack.figures.sheets import drawn
from ev_stack.recording.outcome import bar_of_runs
from ev_stack.report.summary import versions, write_summary
from ev_stack.report.tables import text_table
from ev_stack.running.output_folder import OutputFolder
from ev_study.benchmark.added import check_laws, with_added
from ev_study.benchmark.board import Board, Cell, read_board
from ev_study.benchmark.driving import DrivenCell, drive_cell, drive_law, laws_in_cell
from ev_study.benchmark.held_out import held_out
from ev_study.benchmark.kept_cells import KeptCells
from ev_study.benchmark.ranking.drawing import board_sheet
from ev_study.benchmark.ranking.law_pages import law_page, overview
from ev_study.benchmark.ranking.result import BoardResult
from ev_study.benchmark.ranking.run_files import RUNS, write_runs
from ev_study.benchmark.ranking.tables import (
    CELL_COLUMNS,
    SCORE_COLUMNS,
    cell_rows,
    closed_division,
    score_rows,
)
from ev_study.benchmark.step_times import step_times
from ev_study.studies.digests import digest_of_sources
from ev_study.studies.result_store import ResultStore
from ev_study.studies.workers import load_for, perform_jobs

FIGURE = "board"
PAGES = "laws.md"
FILES = ("board.json", *RUNS, PAGES, f"{FIGURE}.png")
# at most, or all of one law in a cell: preparing a cell takes as long as five runs
RUNS_OF_A_JOB = 100


def run_benchmark(argv: Sequence[str]) -> None:
    """Drive the cells of a board with its laws, and print and write their scores and all runs; or drive one run."""
    given = _parser().parse_args(argv)
    begin = time.monotonic()
    if given.secret and given.board:
        raise ParameterError(
            f"--secret {quoted(given.secret)} is a board, expected no other one beside it"
        )
    board, added = with_added(
        _asked(read_board(given.secret or given.board or "small"), given), given.add
    )
    laws = _laws(board, given.laws, added)
    check_laws(board, laws, added)
    if given.drive:
        _drive_alone(board, given)
        return
    if given.offline or given.in_process:
        raise ParameterError(
            "--offline and --in-process are refused: a board is driven in batches, allowed with --drive"
        )
    cells = board.cells(given.cells)
    out = given.out or Path("results/benchmark")
    results = {} if given.secret else ResultStore(digest_of_sources(config=True))
    kept = KeptCells(board, cells, laws, results)
    if given.anew:
        kept.forget()
    with OutputFolder(out, "benchmark", FILES) as folder:
        before = _drive(board, kept, given.scheduler, given.workers)
        result = BoardResult(board, laws, kept, _words(given), step_times(board, cells[0], laws))
        if not given.secret:
            print(text_table(CELL_COLUMNS, cell_rows(result), left=CELL_COLUMNS))
        for title, division in (("closed", closed_division(result)), ("open", result.laws)):
            if division:
                print(f"\n{title} division")
                print(text_table(SCORE_COLUMNS, score_rows(result, division), left=("law",)))
        _write(folder.directory, result, command_of(["benchmark", *argv]), given, added)
        if not given.no_report:
            save_figures(drawn({FIGURE: board_sheet(result)}), folder.directory)
    print(f"hash of all runs {result.hash}")
    again = f", {before} of them driven before (--anew drives them again)" if before else ""
    total = len(cells) * len(laws) * board.draws
    searches = (
        f", {result.driven} with those of the search for entry speeds,"
        if result.driven > total
        else ""
    )
    print(f"{total} runs{searches} in {time.monotonic() - begin:.1f} s{again}")
    print(f"scores, all runs and figure: {folder.directory}")


def drive_board(board: Board, pattern: str = "*", laws: Sequence[str] = ()) -> BoardResult:
    """Drive the cells that fit with some laws, all if none is named, and keep what they give in memory."""
    chosen = list(laws or board.laws)
    cells = board.cells(pattern)
    kept = KeptCells(board, cells, chosen, {})
    _drive(board, kept)
    return BoardResult(
        board, chosen, kept, ["benchmark", board.name], step_times(board, cells[0], chosen)
    )


def _drive(
    board: Board, kept: KeptCells, scheduler: str | None = None, workers: int | None = None
) -> int:
    """Drive what is missing, some laws in a cell at a time; how many runs were there already."""
    missing = kept.missing()
    if scheduler is None:
        load_for(kept.runs)
    jobs = [job for cell, laws in missing.items() for job in _jobs(board, cell, laws)]
    total, to_drive = (
        sum(map(len, each)) * board.draws for each in (kept.laws_in_cells, missing.values())
    )
    with bar_of_runs("benchmark", total, total - to_drive) as bar:

        def keep(_: int, driven: DrivenCell) -> None:
            kept.keep(driven)
            bar.update(len(driven.metrics) * board.draws)

        perform_jobs(
            drive_cell,
            jobs,
            keep,
            scheduler,
            workers,
            lambda _, cell, laws, __: f"{cell.id('*')}: {laws}",
        )
    return total - to_drive


def _jobs(
    board: Board, cell: Cell, laws: Sequence[str]
) -> Iterator[tuple[Board, Cell, Sequence[str], int]]:
    """What `drive_cell` is called with, on one thread: as many laws as make a job that is worth preparing the cell."""
    manoeuvre = board.manoeuvres[cell.manoeuvre]
    of_law = board.draws * (manoeuvre.halvings if manoeuvre.searched else 1)
    count = max(RUNS_OF_A_JOB // of_law, 1)
    for begin in range(0, len(laws), count):
        yield board, cell, laws[begin : begin + count], 1


def _parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="run.sh benchmark", description="scripts/run.sh benchmark: laws ranked on a board."
    )
    parser.add_argument("board", nargs="?", help="name or path of a board; default: small")
    parser.add_argument(
        "--secret", metavar="FILE", help="a board of which nothing but the scores is written"
    )
    parser.add_argument(
        "--held-out",
        type=int,
        metavar="SEED",
        help="cars, roads and draws that the board holds out",
    )
    parser.add_argument(
        "--cells", default="*", metavar="ID", help="those whose ids fit, such as '*:step_steer:*'"
    )
    parser.add_argument(
        "--laws", metavar="NAME,NAME", help="these, the reference and what is added only"
    )
    parser.add_argument(
        "--add",
        action="append",
        default=[],
        metavar="LAW[=FILE]",
        help="one more law: my_law.py, my_law.py:NAME, a law of the board or a method, with a parameter file",
    )
    parser.add_argument(
        "--draws", type=int, metavar="N", help="of each cell, instead of those of the board"
    )
    parser.add_argument(
        "--seed", type=int, metavar="N", help="of the draws, instead of that of the board"
    )
    where = parser.add_mutually_exclusive_group()
    where.add_argument(
        "--scheduler", metavar="tcp://HOST:PORT", help="a dask scheduler instead of this machine"
    )
    where.add_argument(
        "--workers", type=int, metavar="N", help="worker processes here; default: one per core"
    )
    parser.add_argument("--anew", action="store_true", help="drive again what was driven before")
    parser.add_argument(
        "--drive",
        metavar="LAW:DRAW",
        help="one run of the only cell that fits, as a scenario, over DDS",
    )
    way = parser.add_mutually_exclusive_group()
    way.add_argument("--offline", action="store_true", help="with --drive: no DDS, one process")
    way.add_argument(
        "--in-process", action="store_true", help="with --drive: all nodes in one process, over DDS"
    )
    parser.add_argument("--no-report", action="store_true", help="neither report nor figure")
    parser.add_argument(
        "--out", type=output_folder, metavar="DIR", help="output folder; default results/benchmark"
    )
    add_traceback(parser)
    return parser


def _drive_alone(board: Board, given: argparse.Namespace) -> None:
    """Drive one run as the scenario that it is, with report, figures and signal hash."""
    law, found, number = given.drive.rpartition(":")
    if not found or not number.isdecimal() or int(number) >= board.draws:
        raise ParameterError(
            f"--drive {quoted(given.drive)} is refused, expected LAW:DRAW with a draw from 0 to {board.draws - 1}"
        )
    if law not in board.laws:
        raise unknown_name("law", law, board.laws)
    cells = board.cells(given.cells)
    if len(cells) > 1:
        raise ParameterError(
            f"--drive is for one cell, {len(cells)} fit {quoted(given.cells)}; expected --cells ID"
        )
    runs = laws_in_cell(board, cells[0], [law])[law].only(int(number))
    ((_, *words),), _ = drive_law(replace(board, draws=1), cells[0], runs)
    words += (
        ["--offline"] * given.offline
        + ["--in-process"] * given.in_process
        + ["--no-report"] * given.no_report
    )
    drive_scenario(arguments([*words, *(["--out", str(given.out)] if given.out else [])]))


def _words(given: argparse.Namespace) -> list[str]:
    """Those that make the same draws once more."""
    options = [
        (f"--{name}", str(getattr(given, name)))
        for name in ("draws", "seed")
        if getattr(given, name) is not None
    ]
    options += [("--add", _from_anywhere(word)) for word in given.add]
    if given.held_out is not None:
        options.append(("--held-out", str(given.held_out)))
    return ["benchmark", given.board or "small", *(word for option in options for word in option)]


def _from_anywhere(word: str) -> str:
    """An added law LAW or LAW=PARAMETERS.yaml, with the whole paths of its files."""
    law, equals, file = word.partition("=")
    code, colon, chosen = law.partition(":")
    law = f"{Path(code).absolute()}{colon}{chosen}" if is_code(law) else law
    return f"{law}{equals}{Path(file).absolute() if file else ''}"


def _asked(board: Board, given: argparse.Namespace) -> Board:
    for name, least in (("draws", 1), ("seed", 0), ("workers", 1), ("held_out", 0)):
        if getattr(given, name) is not None and getattr(given, name) < least:
            option = f"--{name.replace('_', '-')} {getattr(given, name)}"
            raise ParameterError(f"{option} is refused, expected {least} or more")
    if given.held_out is not None and given.seed is not None:
        raise ParameterError(
            "--seed is refused beside --held-out: one seed makes cars, roads and draws"
        )
    changed = {
        name: getattr(given, name) for name in ("draws", "seed") if getattr(given, name) is not None
    }
    board = replace(board, **changed)
    return board if given.held_out is None else held_out(board, given.held_out)


def _laws(board: Board, names: str | None, added: Sequence[str]) -> list[str]:
    asked = [board.reference, *(board.laws if names is None else names.split(",")), *added]
    for name in asked:
        if name not in board.laws:
            raise unknown_name("law", name, board.laws)
    return list(dict.fromkeys(asked))


def _write(
    folder: Path, result: BoardResult, command: str, given: argparse.Namespace, added: Sequence[str]
) -> None:
    about = {"held_out": given.held_out, "versions": versions(), "command": command}
    if given.secret:
        digest = hashlib.sha256(read_data(Path(given.secret), TEXT)).hexdigest()
        kept = {
            name: of for name, of in result.as_json().items() if name not in ("cells", "recorded")
        }
        write_summary(folder / "board.json", kept | {"board_sha256": digest} | about)
        return
    write_summary(folder / "board.json", result.as_json() | about)
    write_runs(folder, result)
    order = [*added, *(law for law in result.laws if law not in (*added, result.board.reference))]
    pages = [law_page(result, law) for law in order]
    whole = [f"# Laws on the board {result.board.name}\n", overview(result), *pages]
    (folder / PAGES).write_text("\n".join(whole), encoding="utf-8")
