"""The command scripts/run.sh tune: the parameters of laws by CMA-ES on a board (docs/benchmark.md).

It raises what `ev_stack.commands.run_scenario.main` catches.

How it works: the board gives training and validation cases by two seeds. A law is searched on the
first, its best candidates and its start are then driven on the second, and the one of the least
cost there is written. All laws have the same cases, budget and start of the search.
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from ev_msgs_py.refusal import ParameterError
from ev_stack.command_line.numbers import whole
from ev_stack.command_line.options import add_traceback, command_of
from ev_stack.command_line.paths import add_out
from ev_stack.command_line.refusal import Parser
from ev_stack.recording.outcome import announce, bar_of_runs
from ev_stack.recording.recording import atomic_file
from ev_stack.running.output_folder import output_folder
from ev_study.benchmark.added import check_laws, with_added
from ev_study.benchmark.board import COSTS, Board, by_role, read_board
from ev_study.benchmark.cell_runs import law_of, run_of, values_of
from ev_study.benchmark.held_out import with_cases
from ev_study.benchmark.kept_cells import kept_cells
from ev_study.studies.digests import digest_of_sources, short_digest
from ev_study.studies.kept_rows import Key
from ev_study.studies.result_store import Answers, ResultStore
from ev_study.tuning.free import Free, free_parameters
from ev_study.tuning.search import Candidate, chosen, search
from ev_study.tuning.training import Reference, Training

ALL = "all"
PARTS = ("training", "validation")  # of the cases of a board


def run_tune(argv: Sequence[str]) -> None:
    """Tune laws with a budget of candidates each, and write their parameters and the histories of the searches."""
    given = _parser().parse_args(argv)
    board = replace(read_board(given.board), draws=given.draws)
    laws = list(board.tuned) if given.laws == [ALL] else list(dict.fromkeys(given.laws))
    others = [law for law in laws if law not in board.laws]
    board, added = with_added(board, others)
    by_word = dict(zip(others, added, strict=True))
    names = [by_word.get(law, law) for law in laws]
    check_laws(board, names, added)
    free = {name: _free(board, name, given) for name in names}
    for law, of in free.items():
        for each in of:
            # the first steps are a part of all its range, however large that is
            if not each.by_factors:
                announce(
                    f"note: {law}: {each.name} starts at {each.start:g}: from {each.low:g} to"
                    f" {each.high:g}"
                )
    references = _references(board, given)
    keys = {name: search_key(references, name, free[name], given) for name in names}
    results = ResultStore(digest_of_sources(config=True))
    command = command_of(["tune", *argv])
    with output_folder(given.out, "tune") as folder:
        for name in names:
            # Each law reads its car and files once more when its search begins.
            answers = Answers(results, keys[name].digest, keys[name].refuse_changed)
            _tune(name, folder, references, free[name], answers, given, command)


def _parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="run.sh tune",
        description="scripts/run.sh tune: parameters of laws by CMA-ES on a board.",
    )
    parser.add_argument(
        "laws",
        nargs="+",
        help=f"laws of the board, methods, my_law.py[:NAME]; {ALL}: those that the board has tuned",
    )
    parser.add_argument(
        "--free",
        metavar="NAME,NAME",
        help="numbers of a law, such as 'pi.*'; default: those of the board, or all",
    )
    parser.add_argument(
        "--board", default="small", metavar="NAME", help="or its path; default: %(default)s"
    )
    parser.add_argument(
        "--cells", default="*", metavar="ID", help="training runs: those of which the ids fit"
    )
    parser.add_argument(
        "--draws", type=whole(1), default=2, metavar="N", help="of each cell; default: %(default)s"
    )
    parser.add_argument(
        "--seed",
        type=whole(0),
        default=1000,
        metavar="N",
        help="of draws and search; default: %(default)s",
    )
    parser.add_argument(
        "--budget", type=whole(2), default=40, metavar="N", help="candidates; default: %(default)s"
    )
    parser.add_argument(
        "--finalists",
        type=whole(1),
        default=5,
        metavar="N",
        help="candidates that validation chooses among; %(default)s",
    )
    parser.add_argument("--cost", choices=COSTS, default=COSTS[0], help="default: %(default)s")
    parser.add_argument("--threads", type=whole(1), metavar="N", help="default: one per core")
    add_out(parser, "tune")
    add_traceback(parser)
    return parser


def _references(board: Board, given: argparse.Namespace) -> list[Reference]:
    """Those of training and of validation."""
    training = with_cases(board, PARTS[0], given.seed)
    cells = [
        cell
        for cell in training.cells(given.cells)
        if not board.manoeuvres[cell.manoeuvre].searched
    ]
    if not cells:
        raise ParameterError("--cells leaves none to tune on: entry speeds are not tuned for")
    # Validation cars differ, so cells are matched by what is driven where.
    kept = {(cell.manoeuvre, cell.road) for cell in cells}
    # Another seed, so that no road or draw is the same.
    validation = with_cases(board, PARTS[1], given.seed + 1)
    others = [cell for cell in validation.cells() if (cell.manoeuvre, cell.road) in kept]
    if not others:
        raise ParameterError("--cells leaves none to validate on: no validation car drives them")
    return [
        Reference(of, each, given.threads) for of, each in ((training, cells), (validation, others))
    ]


def _free(board: Board, law: str, given: argparse.Namespace) -> list[Free]:
    """The numbers of a law that are free; they start where they are for the first car."""
    training = with_cases(board, PARTS[0], given.seed)
    cell = training.cells(given.cells)[0]
    patterns = given.free.split(",") if given.free is not None else board.tuned.get(law, ["*"])
    return free_parameters(
        law, law_of(training, law, run_of(training, cell, values_of(training, cell))), patterns
    )


def _tune(
    name: str,
    folder: Path,
    references: Sequence[Reference],
    free: Sequence[Free],
    answers: Answers,
    given: argparse.Namespace,
    command: str,
) -> None:
    # The runs of both are asked for at the same numbers of cells.
    in_training, in_validation = asked = [partial(answers.answer, part) for part in PARTS]
    training, validation = (
        Training(of.board, name, of.driven(answer), given.cost, given.threads)
        for of, answer in zip(references, asked, strict=True)
    )
    # Counted from here: laws that were tuned before in this command have taken some, too.
    taken, reference = answers.taken, references[0].board.reference
    history, more = [], min(given.finalists + 1, given.budget) * validation.runs
    with bar_of_runs(f"tune {name}", given.budget * training.runs + more) as bar:
        for candidate in search(training, free, given.budget, given.seed, in_training):
            history.append(candidate)
            bar.update(training.runs)
        best, cost, before = chosen(history, validation, free, given.finalists, in_validation)
        bar.update(more)
    lines = [
        command,
        (
            f"{given.cost} in {training.runs} training runs {history[0].cost:.4f}, tuned"
            f" {best.cost:.4f}"
        ),
        f"{given.cost} in {validation.runs} validation runs {before:.4f}, tuned {cost:.4f}",
        f"{reference} in these {training.of_reference:.4f} and {validation.of_reference:.4f}",
    ]
    # A law that costs more than the reference is worse than none.
    if cost > validation.of_reference:
        lines.append(f"so it is worse there than {reference}, tuned as well")
    print("\n".join([f"law {name}", *lines[1:]]))
    for each in free:
        print(f"  {each.name:40} {each.start:.6g} -> {best.values[each.name]:.6g}")
    result = folder / f"{name}_tuned.yaml"
    _write(result, free, best, lines)
    _write_history(folder / f"{name}_history.csv", history)
    if answers.taken > taken:
        print(f"went on behind {answers.taken - taken} generations of an earlier search")
    print(f"{len(history)} candidates of {training.runs} runs; parameters: {result}")


def search_key(
    references: Sequence[Reference], law: str, free: Sequence[Free], given: argparse.Namespace
) -> Key:
    """Return the key of all that the costs of a law depend on but the candidates.

    That is of its runs, and of those of the reference.
    """
    runs = []
    files: dict[str, str] = {}
    for of in references:
        rows = kept_cells(of.board, of.cells, [of.board.reference, law], {}).rows
        runs.append(rows.names)
        files |= rows.files
    scales = [of.board.scales for of in references]
    return Key(short_digest((runs, scales, [*free], given.cost, given.seed)), files)


def _write(path: Path, free: Sequence[Free], best: Candidate, lines: Sequence[str]) -> None:
    """A parameter file.

    The numbers are as exact as they were driven, and beside them is what they were before.
    """
    text, before = (
        [f"# {line}" for line in lines],
        by_role({each.name: each.start for each in free}),
    )
    for role, values in by_role(best.values).items():
        rows = [
            f"    {name}: {value!r}    # before: {before[role][name]:g}"
            for name, value in values.items()
        ]
        text += [f"/**/{role}:", "  ros__parameters:", *rows] if rows else []
    with atomic_file(path) as file:
        file.write("\n".join([*text, ""]).encode())


def _write_history(path: Path, history: Sequence[Candidate]) -> None:
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["candidate", "cost", *history[0].values])
        writer.writerows([n, each.cost, *each.values.values()] for n, each in enumerate(history))
