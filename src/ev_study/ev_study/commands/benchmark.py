"""The command scripts/run.sh benchmark: laws ranked on a board (docs/benchmark.md).

It raises what `ev_stack.commands.run_scenario.main` catches.

How it works: the board is read and checked with all its laws, before anything is driven. Rows of
earlier commands are taken from the store; the rest are jobs of one cell and some laws each. Scores,
records and pages are made from the rows, read cell by cell. `--drive` finds the command of one run
and drives that as a scenario.
"""

from __future__ import annotations

import argparse
import hashlib
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from ev_core.lockstep.finding import is_code
from ev_core.parameters.data_file import TEXT, read_data
from ev_msgs_py.refusal import ParameterError, quoted, unknown_name
from ev_stack.command_line.numbers import whole
from ev_stack.command_line.options import arguments, command_of
from ev_stack.command_line.refusal import Parser
from ev_stack.commands.drive_scenario import drive_scenario
from ev_stack.figures.saving import save_figures
from ev_stack.figures.sheets import drawn
from ev_stack.report.summary import versions, write_summary
from ev_stack.running.output_folder import output_folder
from ev_study.benchmark.added import check_laws, with_added
from ev_study.benchmark.board import Board, Cell, read_board
from ev_study.benchmark.driving import DrivenCell, drive_cell, drive_law, laws_in_cell
from ev_study.benchmark.held_out import held_out
from ev_study.benchmark.kept_cells import KeptCells, kept_cells
from ev_study.benchmark.ranking.drawing import board_sheet
from ev_study.benchmark.ranking.law_pages import law_page, overview
from ev_study.benchmark.ranking.result import BoardResult
from ev_study.benchmark.ranking.run_files import write_runs
from ev_study.benchmark.ranking.tables import cell_table, closed_division, score_table
from ev_study.benchmark.step_times import step_times
from ev_study.studies.digests import digest_of_sources
from ev_study.studies.driving import load_for
from ev_study.studies.options import add_driving, once_more, workers_of
from ev_study.studies.result_store import ResultStore
from ev_study.studies.workers import HERE, Job, Workers, perform_jobs

FIGURE = "board"
PAGES = "laws.md"
RUNS_OF_A_JOB = 100  # at most, or all of one law in a cell: preparing a cell takes as long as five


def run_benchmark(argv: Sequence[str]) -> None:
    """Drive the cells of a board with its laws and write their scores and runs, or drive one run.

    Scores and cells are printed as well.
    """
    given = _parser().parse_args(argv)
    begin = time.monotonic()
    if given.secret and given.board:
        raise ParameterError(
            f"--secret {quoted(given.secret)} is a board, expected no other one beside it"
        )
    board = _asked(read_board(given.secret or given.board or "small"), given)
    board, added = with_added(board, given.add)
    laws = _laws(board, given.laws, added)
    check_laws(board, laws, added)
    if given.drive:
        _drive_alone(board, given)
        return
    # Only a single run can be driven in another way.
    if given.offline or given.in_process:
        raise ParameterError(
            "--offline and --in-process are refused: a board is driven in batches, "
            "expected with --drive"
        )
    cells = board.cells(given.cells)
    # Nothing of the runs of a secret board is left on the disk.
    store = {} if given.secret else ResultStore(digest_of_sources(config=True))
    kept = kept_cells(board, cells, laws, store, given.anew)
    with output_folder(given.out, "benchmark") as folder:
        before = _drive(board, kept, workers_of(given))
        times = step_times(board, cells[0], laws)
        result = BoardResult(board, laws, kept, _words(given), times)
        _print(result, given)
        _write(folder, result, command_of(["benchmark", *argv]), given, added)
        if not given.no_report:
            save_figures(drawn({FIGURE: board_sheet(result)}), folder)
    print(f"hash of all runs {result.hash}")
    total = len(cells) * len(laws) * board.draws
    searches = ""
    if result.driven > total:
        searches = f", {result.driven} with those of the search for entry speeds,"
    print(f"{total} runs{searches} in {time.monotonic() - begin:.1f} s{once_more(before)}")
    print(f"scores, all runs and figure: {folder}")


def drive_board(board: Board, pattern: str = "*", laws: Sequence[str] = ()) -> BoardResult:
    """Drive the cells that fit with some laws, all if none is named, and keep rows in memory."""
    chosen = list(laws or board.laws)
    cells = board.cells(pattern)
    kept = kept_cells(board, cells, chosen, {})
    _drive(board, kept, HERE)
    times = step_times(board, cells[0], chosen)
    return BoardResult(board, chosen, kept, ["benchmark", board.name], times)


def _drive(board: Board, kept: KeptCells, workers: Workers) -> int:
    """Drive what is missing, some laws in a cell at a time; how many runs were there already."""
    jobs = [job for cell, laws in kept.missing().items() for job in _jobs(board, cell, laws)]
    total = len(kept) * len(kept.laws) * board.draws
    before = total - sum(job.runs for job in jobs)
    if workers.scheduler is None:
        load_for(kept.runs)

    def keep(_: int, driven: DrivenCell) -> None:
        kept.keep(driven)

    perform_jobs("benchmark", jobs, keep, workers, before)
    return before


def _jobs(board: Board, cell: Cell, laws: Sequence[str]) -> Iterator[Job]:
    """Give jobs of one thread each, with as many laws as are worth preparing the cell."""
    manoeuvre = board.manoeuvres[cell.manoeuvre]
    of_law = board.draws * (manoeuvre.halvings if manoeuvre.searched else 1)
    # A search is counted as one run for each halving.
    count = max(RUNS_OF_A_JOB // of_law, 1)
    for begin in range(0, len(laws), count):
        some = laws[begin : begin + count]
        name = f"{cell.id('*')}: {some}"
        # One thread: the processes fill the cores already.
        yield Job(name, drive_cell, (board, cell, some, 1), len(some) * board.draws)


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
        type=whole(0),
        metavar="SEED",
        help="cars, roads and draws that the board holds out",
    )
    parser.add_argument(
        "--cells",
        default="*",
        metavar="ID",
        help="those with ids that fit, such as '*:step_steer:*'",
    )
    parser.add_argument(
        "--laws", metavar="NAME,NAME", help="these, the reference and what is added only"
    )
    parser.add_argument(
        "--add",
        action="append",
        default=[],
        metavar="LAW[=FILE]",
        help="one more law: my_law.py, my_law.py:NAME, a law of the board or a method, "
        "with a parameter file",
    )
    parser.add_argument(
        "--draws",
        type=whole(1),
        metavar="N",
        help="of each cell, instead of those of the board",
    )
    parser.add_argument(
        "--seed", type=whole(0), metavar="N", help="of the draws, instead of that of the board"
    )
    add_driving(parser, "benchmark")
    parser.add_argument(
        "--drive",
        metavar="LAW:DRAW",
        help="one run of the only cell that fits, as a scenario, over DDS",
    )
    way = parser.add_mutually_exclusive_group()
    way.add_argument("--offline", action="store_true", help="with --drive: no DDS, one process")
    way.add_argument(
        "--in-process",
        action="store_true",
        help="with --drive: all nodes in one process, over DDS",
    )
    parser.add_argument("--no-report", action="store_true", help="neither report nor figure")
    return parser


def _drive_alone(board: Board, given: argparse.Namespace) -> None:
    """Drive one run as the scenario that it is, with report, figures and signal hash."""
    law, found, number = given.drive.rpartition(":")
    if not found or not number.isdecimal() or int(number) >= board.draws:
        raise ParameterError(
            f"--drive {quoted(given.drive)} is refused, expected LAW:DRAW "
            f"with a draw from 0 to {board.draws - 1}"
        )
    if law not in board.laws:
        raise unknown_name("law", law, board.laws)
    cells = board.cells(given.cells)
    if len(cells) > 1:
        fit = f"{len(cells)} fit {quoted(given.cells)}"
        raise ParameterError(f"--drive is for one cell, {fit}; expected --cells ID")
    runs = laws_in_cell(board, cells[0], [law])[law].only(int(number))
    # Driven once in a batch here: a search has to find its speed before the command is known.
    ((_, *words),), _ = drive_law(replace(board, draws=1), cells[0], runs)
    for option in ("offline", "in_process", "no_report"):
        if getattr(given, option):
            words.append(f"--{option.replace('_', '-')}")
    if given.out:
        words += ["--out", str(given.out)]
    drive_scenario(arguments(words))


def _words(given: argparse.Namespace) -> list[str]:
    """Return the words that make the same draws once more."""
    words = ["benchmark", given.board or "small"]
    for name in ("draws", "seed"):
        if (value := getattr(given, name)) is not None:
            words += [f"--{name}", str(value)]
    for word in given.add:
        words += ["--add", _from_anywhere(word)]
    if given.held_out is not None:
        words += ["--held-out", str(given.held_out)]
    return words


def _from_anywhere(word: str) -> str:
    """Return an added law LAW or LAW=PARAMETERS.yaml with the whole paths of its files."""
    law, equals, file = word.partition("=")
    code, colon, chosen = law.partition(":")
    law = f"{Path(code).absolute()}{colon}{chosen}" if is_code(law) else law
    # The command may be repeated in another folder.
    return f"{law}{equals}{Path(file).absolute() if file else ''}"


def _asked(board: Board, given: argparse.Namespace) -> Board:
    """Return the board with the draws, the seed or the held-out cases that are asked for."""
    if given.held_out is not None and given.seed is not None:
        raise ParameterError(
            "--seed is refused beside --held-out: one seed makes cars, roads and draws"
        )
    if given.draws is not None:
        board = replace(board, draws=given.draws)
    if given.seed is not None:
        board = replace(board, seed=given.seed)
    return board if given.held_out is None else held_out(board, given.held_out)


def _laws(board: Board, names: str | None, added: Sequence[str]) -> list[str]:
    # The reference is always driven: costs are against it.
    asked = [board.reference, *(board.laws if names is None else names.split(",")), *added]
    for name in asked:
        if name not in board.laws:
            raise unknown_name("law", name, board.laws)
    return list(dict.fromkeys(asked))


def _print(result: BoardResult, given: argparse.Namespace) -> None:
    """Print the cells, unless the board is secret, and the scores of both divisions."""
    if not given.secret:
        print(cell_table(result).text())
    divisions = {"closed": closed_division(result), "open": result.laws}
    for title, laws in divisions.items():
        if laws:
            print(f"\n{title} division")
            print(score_table(result, laws).text())


def _write(
    folder: Path,
    result: BoardResult,
    command: str,
    given: argparse.Namespace,
    added: Sequence[str],
) -> None:
    """Write scores, records of all runs and the pages of the laws; of a secret board the scores."""
    about: dict[str, Any] = {"held_out": given.held_out}
    about |= {"versions": versions(), "command": command}
    content = result.as_json()
    if given.secret:
        digest = hashlib.sha256(read_data(Path(given.secret), TEXT)).hexdigest()
        about = {"board_sha256": digest, **about}
        # Names of cells and metrics tell what the secret board drives.
        content = {name: of for name, of in content.items() if name not in ("cells", "recorded")}
    write_summary(folder / "board.json", content | about)
    if given.secret:
        return
    write_runs(folder, result)
    others = [law for law in result.laws if law not in (*added, result.board.reference)]
    pages = [law_page(result, law) for law in (*added, *others)]
    whole = [f"# Laws on the board {result.board.name}\n", overview(result), *pages]
    (folder / PAGES).write_text("\n".join(whole), encoding="utf-8")
