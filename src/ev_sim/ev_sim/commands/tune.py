"""The command scripts/run.sh tune: the parameters of a law by CMA-ES on a board (docs/benchmark.md).

It raises what `ev_sim.commands.run_scenario.main` catches.
"""

from __future__ import annotations

import argparse
import csv
import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from ev_core.lockstep.finding import is_code
from ev_core.parameters.data_file import TEXT, read_data
from ev_msgs_py.refusal import ParameterError
from ev_sim.benchmark.added import check_laws, with_added
from ev_sim.benchmark.board import COSTS, Board, read_board
from ev_sim.benchmark.driving import ROLE
from ev_sim.benchmark.tuning import Training, free_parameters, tune
from ev_sim.command_line.options import command_of
from ev_sim.command_line.refusal import Parser
from ev_sim.measured.journal import Journal
from ev_sim.recording.outcome import bar_of_runs
from ev_sim.recording.recording import atomic_file
from ev_sim.running.output_folder import OutputFolder
from ev_sim.study.kept_rows import digest_of_sources

HISTORY, JOURNAL = "history.csv", "search.journal"


def run_tune(argv: Sequence[str]) -> None:
    """Tune a law with a budget of candidates, and write its parameters and the history of the search."""
    given = _parser().parse_args(argv)
    for name, least in (("draws", 1), ("seed", 0), ("threads", 1), ("budget", 2)):
        if getattr(given, name) is not None and getattr(given, name) < least:
            raise ParameterError(f"--{name} {getattr(given, name)} is refused, allowed is {least} or more")
    board, name = _with_law(replace(read_board(given.board), draws=given.draws, seed=given.seed), given.law)
    cells = [cell for cell in board.cells(given.cells) if not board.manoeuvres[cell.manoeuvre].searched]
    if not cells:
        raise ParameterError("--cells leaves none to tune on: entry speeds are not tuned for")
    result = f"{name}_tuned.yaml"
    with OutputFolder(
        given.out or Path("results/tune") / name, "tune", (result, HISTORY, JOURNAL), keeps=[JOURNAL]
    ) as f:
        training = Training(board, cells, name, given.cost, given.threads)
        free = free_parameters(board, name, training.configuration, given.free.split(","))
        journal = Journal(f.directory / JOURNAL, _key(board, given))
        history = []
        with bar_of_runs("tune", given.budget * training.runs) as bar:
            for values, cost in tune(training, free, given.budget, given.seed, journal.answer):
                history.append((values, cost))
                bar.update(training.runs)
        values, cost = min(history, key=lambda each: each[1])
        print(f"{given.cost} cost on the training runs: {history[0][1]:.4f} before, {cost:.4f} tuned; 1: equal torques")
        for each in free:
            print(f"  {each.name:40} {each.start:.6g} -> {values[each.name]:.6g}")
        _write(f.directory / result, values, history[0][1], cost, command_of(["tune", *argv]))
        _write_history(f.directory / HISTORY, history)
        journal.remove()
    if journal.taken:
        print(f"went on behind {journal.taken} generations of a search that was stopped")
    print(f"{len(history)} candidates of {training.runs} runs; parameters: {f.directory / result}")


def _parser() -> argparse.ArgumentParser:
    parser = Parser(prog="run.sh tune", description="scripts/run.sh tune: a law's parameters by CMA-ES on a board.")
    parser.add_argument("law", help="a law of the board, a method, or my_law.py[:NAME]")
    parser.add_argument(
        "--free", default="*", metavar="NAME,NAME", help="numbers of the law, such as 'pi.*'; all of them"
    )
    parser.add_argument("--board", default="small", metavar="NAME", help="or its path; default: %(default)s")
    parser.add_argument("--cells", default="*", metavar="ID", help="training runs: those of which the ids fit")
    parser.add_argument("--draws", type=int, default=2, metavar="N", help="of each cell; default: %(default)s")
    parser.add_argument("--seed", type=int, default=1000, metavar="N", help="of draws and search; default: %(default)s")
    parser.add_argument("--budget", type=int, default=200, metavar="N", help="candidates; default: %(default)s")
    parser.add_argument("--cost", choices=COSTS, default=COSTS[0], help="default: %(default)s")
    parser.add_argument("--threads", type=int, metavar="N", help="default: one per core")
    parser.add_argument("--out", type=Path, metavar="DIR", help="output folder; default results/tune/LAW")
    return parser


def _with_law(board: Board, law: str) -> tuple[Board, str]:
    if law in board.laws:
        return board, law
    board, (name,) = with_added(board, [law])
    check_laws(board, [name])
    return board, name


def _key(board: Board, given: argparse.Namespace) -> str:
    """A digest of all that the costs depend on but the candidates."""
    file = given.law.partition(":")[0]
    text = read_data(Path(file), TEXT) if is_code(given.law) else b""
    choices = (digest_of_sources(), board, given.law, given.free, given.cells, given.cost)
    return hashlib.sha256(repr(choices).encode() + text).hexdigest()


def _write(path: Path, values: Mapping[str, float], before: float, after: float, command: str) -> None:
    """A parameter file; the numbers are as exact as they were driven."""
    lines = [f"# {command}", f"# cost on the training runs {before:.6f} before, {after:.6f} tuned"]
    lines += [f"/**/{ROLE}:", "  ros__parameters:", *(f"    {name}: {value!r}" for name, value in values.items())]
    with atomic_file(path) as file:
        file.write("\n".join([*lines, ""]).encode())


def _write_history(path: Path, history: Sequence[tuple[Mapping[str, float], float]]) -> None:
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["candidate", "cost", *history[0][0]])
        writer.writerows([n, cost, *values.values()] for n, (values, cost) in enumerate(history))
