"""The command scripts/run.sh replay: one role of a recorded run is played again, and its answers are compared.

It raises what `ev_stack.commands.run_scenario.main` catches.
"""

from __future__ import annotations

import shlex
import shutil
from collections.abc import Sequence
from pathlib import Path

from ev_core.lockstep.finding import LIBRARIES, is_code
from ev_core.methods.register import methods_of
from ev_msgs_py.refusal import ParameterError, quoted
from ev_stack.command_line.options import add_changes, add_outputs, command_of, overrides, printing
from ev_stack.command_line.paths import add_out
from ev_stack.command_line.refusal import Parser
from ev_stack.recording.outcome import Outcome, progress_bar
from ev_stack.running.beforehand import compile_for
from ev_stack.running.offline import run_offline_into
from ev_stack.running.output_folder import output_folder
from ev_stack.scenarios.records import Run
from ev_study.replay.graph import REPLAYED, Replay, Replayed, prepared, replay_of
from ev_study.replay.recorded import find_recorded


def run_replay(argv: Sequence[str]) -> None:
    """Replay one role of a recorded run, and print and write what differs."""
    about = "recorded inputs into a law or a node, its answers beside the recorded ones."
    parser = Parser(prog="run.sh replay", description=f"scripts/run.sh replay: {about}")
    add_out(parser, "replay")
    parser.add_argument(
        "bag", type=Path, metavar="BAG", help="a bag, the folder of a run, or its signals.npz"
    )
    parser.add_argument(
        "--node",
        required=True,
        metavar="NODE[=METHOD_OR_COMMAND]",
        help="what is played again: by the recorded method, by another one, or by your own node",
    )
    parser.add_argument(
        "--namespace", default="", metavar="NS", help="that of the topics, if a bag has several"
    )
    add_changes(parser)
    add_outputs(parser)
    given = parser.parse_args(argv)
    prints = printing(given)
    role, _, text = given.node.partition("=")
    recorded = find_recorded(given.bag, given.namespace)
    # Before the parameters are resolved: they depend on the method.
    method, command = _meant(role, text)
    replay = replay_of(recorded, role, method, overrides(given))
    with output_folder(given.out, "replay") as folder:
        run = prepared(replay, folder)
        outcome = _play(replay, run, folder / REPLAYED, command)
        found = replay.differences(outcome.recording)
        replayed = Replayed(replay, run, outcome, found, command, command_of(["replay", *argv]))
        print("\n".join(replayed.lines()))
        page = replayed.write(folder, not given.no_report, prints)
    print(f"{page}table, signals and summary: {folder}")


def _meant(role: str, text: str) -> tuple[str, list[str]]:
    """The method or the words of the command that stands behind NODE=.

    Raises ParameterError if it is neither.
    """
    known = methods_of(role)
    if not text or text in known or text.endswith(LIBRARIES):
        return text, []
    try:
        words = shlex.split(text)
    except ValueError as error:
        raise ParameterError(f"--node {quoted(text)} is refused: {error}") from None
    # What can be executed is a program, whatever its suffix; a law file usually cannot.
    if not words or shutil.which(words[0]) is None:
        if is_code(text):
            return text, []
        methods = f"a method ({', '.join(known)})" if known else "a method"
        raise ParameterError(
            f"--node {role}={text} is refused, expected {methods}, a library, law file or program"
        )
    return "", words


def _play(replay: Replay, run: Run, folder: Path, command: list[str]) -> Outcome:
    # A program of the user's has nothing of ours to compile.
    compile_for([run], bool(command), [replay.role] if command else ())
    with progress_bar(f"replay of {replay.role}", run.duration) as progress:
        if not command:
            return run_offline_into(run, folder, False, progress)
        from ev_stack.running.processes import run_in_processes

        return run_in_processes(run, folder, False, progress, {replay.role: command})
