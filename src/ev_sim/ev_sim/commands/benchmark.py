"""The command scripts/run.sh benchmark: laws ranked on a board (docs/benchmark.md).

It raises what `ev_sim.commands.run_scenario.main` catches.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from ev_msgs_py.refusal import ParameterError, unknown_name
from ev_sim.benchmark.added import check_laws, with_added
from ev_sim.benchmark.board import Board, read_board
from ev_sim.benchmark.driving import drive_cell
from ev_sim.benchmark.result import CELL_COLUMNS, COLUMNS, BoardResult
from ev_sim.command_line.options import command_of
from ev_sim.command_line.refusal import Parser
from ev_sim.recording.outcome import bar_of_runs
from ev_sim.report.summary import versions, write_summary
from ev_sim.report.tables import text_table, write_parquet
from ev_sim.running.output_folder import OutputFolder

FILES = ("board.json", "runs.json", "runs.parquet")


def run_benchmark(argv: Sequence[str]) -> None:
    """Drive the cells of a board with its laws, and print and write their scores and all runs."""
    parser = Parser(prog="run.sh benchmark", description="scripts/run.sh benchmark: laws ranked on a board.")
    parser.add_argument("board", nargs="?", default="small", help="name or path of a board; default: %(default)s")
    parser.add_argument("--cells", default="*", metavar="ID", help="those whose ids fit, such as '*:step_steer:*'")
    parser.add_argument("--laws", metavar="NAME,NAME", help="these and the reference only")
    parser.add_argument(
        "--add",
        action="append",
        default=[],
        metavar="LAW[=FILE]",
        help="one more law: my_law.py, my_law.py:NAME, a law of the board or a method, with a parameter file",
    )
    parser.add_argument("--draws", type=int, metavar="N", help="of each cell, instead of those of the board")
    parser.add_argument("--seed", type=int, metavar="N", help="of the draws, instead of that of the board")
    parser.add_argument("--threads", type=int, metavar="N", help="default: one per core")
    parser.add_argument("--out", type=Path, default=Path("results/benchmark"), metavar="DIR", help="%(default)s")
    given = parser.parse_args(argv)
    begin = time.monotonic()
    board, added = with_added(_asked(read_board(given.board), given), given.add)
    laws = _laws(board, given.laws, added)
    check_laws(board, added)
    with OutputFolder(given.out, "benchmark", FILES) as folder:
        result = drive_board(board, given.cells, laws, given.threads)
        print(text_table(CELL_COLUMNS, result.cell_rows(), left=CELL_COLUMNS))
        print()
        print(text_table(COLUMNS, result.rows(), left=("law",)))
        _write(folder.directory, result, command_of(["benchmark", *argv]))
    runs = len(result.cells) * len(result.laws) * board.draws
    print(f"hash of all runs {result.hash}")
    print(f"{runs} runs in {time.monotonic() - begin:.1f} s; scores and all runs: {folder.directory}")


def drive_board(board: Board, pattern: str = "*", laws: Sequence[str] = (), threads: int | None = None) -> BoardResult:
    """Drive the cells that fit with some laws, all of the board if none is named."""
    chosen, cells, driven = laws or list(board.laws), board.cells(pattern), []
    with bar_of_runs("benchmark", len(cells) * len(chosen) * board.draws) as bar:
        for cell in cells:
            driven.append(drive_cell(board, cell, chosen, threads))
            bar.update(len(chosen) * board.draws)
    return BoardResult(board, chosen, driven)


def _asked(board: Board, given: argparse.Namespace) -> Board:
    for name, least in (("draws", 1), ("seed", 0), ("threads", 1)):
        if getattr(given, name) is not None and getattr(given, name) < least:
            raise ParameterError(f"--{name} {getattr(given, name)} is refused, allowed is {least} or more")
    changed = {name: getattr(given, name) for name in ("draws", "seed") if getattr(given, name) is not None}
    return replace(board, **changed)


def _laws(board: Board, names: str | None, added: Sequence[str]) -> list[str]:
    asked = [board.reference, *(names.split(",") if names else board.laws), *added]
    for name in asked:
        if name not in board.laws:
            raise unknown_name("law", name, board.laws)
    return list(dict.fromkeys(asked))


def _write(folder: Path, result: BoardResult, command: str) -> None:
    write_summary(folder / "board.json", result.as_json() | {"versions": versions(), "command": command})
    runs = result.runs()
    write_summary(folder / "runs.json", {"runs": runs})
    names = dict.fromkeys(name for run in runs for name in run)
    write_parquet(folder / "runs.parquet", {name: [run.get(name) for run in runs] for name in names})
