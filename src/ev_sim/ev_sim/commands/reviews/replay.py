"""scripts/run.sh replay: recorded inputs into a law or a node, its answers beside the recorded ones."""

from __future__ import annotations

import argparse
import shlex
import shutil
from collections.abc import Sequence
from pathlib import Path

from ev_core.lockstep.finding import LIBRARIES, is_code
from ev_core.methods.register import methods_of
from ev_msgs_py.refusal import ParameterError, quoted
from ev_sim.command_line.options import add_changes, add_outputs, command_of, overrides
from ev_sim.command_line.refusal import Parser
from ev_sim.recording.files_of_run import PARAMETERS, SIGNALS
from ev_sim.recording.outcome import Outcome
from ev_sim.recording.progress_bar import progress_bar
from ev_sim.recording.recording import save
from ev_sim.replay.comparing import differences_of
from ev_sim.replay.finding import find_recorded
from ev_sim.replay.graph import Replay, replay_of
from ev_sim.replay.outputs import Replayed, prepared, replay_folder
from ev_sim.running.node_parameters import node_parameters, write_parameter_file
from ev_sim.running.offline import drive_offline
from ev_sim.scenarios.scenario import Run


def run_replay(argv: Sequence[str]) -> None:
    """Replay one role of a recorded run, say what differs, and write it; raises what `run_scenario.main` catches."""
    given = _arguments(argv)
    role, _, text = given.node.partition("=")
    recorded = find_recorded(given.bag, given.namespace)
    method, command = _meant(role, text)
    replay = replay_of(recorded, role, method, overrides(given))
    with replay_folder(replay, given.out or Path("results") / "replay") as folders:
        run = prepared(replay, folders)
        outcome = _drive(replay, run, folders.of(run), command)
        found = differences_of(replay, outcome.recording)
        replayed = Replayed(replay, run, outcome, found, command, command_of(["replay", *argv]))
        print("\n".join(replayed.lines()))
        page = replayed.write(folders, not given.no_report, given.figures)
    print(f"{page}table, signals and summary: {folders.directory}")


def _arguments(argv: Sequence[str]) -> argparse.Namespace:
    parser = Parser(prog="run.sh replay", description=__doc__)
    parser.add_argument("bag", type=Path, metavar="BAG", help="a bag, the folder of a run, or its signals.npz")
    parser.add_argument(
        "--node",
        required=True,
        metavar="NODE[=METHOD_OR_COMMAND]",
        help="what is played anew: by the recorded method, by another one, or by your own node",
    )
    parser.add_argument("--namespace", default="", metavar="NS", help="that of the topics, if a bag has several")
    add_changes(parser)
    add_outputs(parser)
    parser.add_argument("--out", type=Path, metavar="DIR", help="output folder; default results/replay")
    return parser.parse_args(argv)


def _meant(role: str, text: str) -> tuple[str, list[str]]:
    """The method or the words of the command that stands behind NODE=; ParameterError if it is neither."""
    known = methods_of(role)
    if not text or text in known or text.endswith(LIBRARIES):
        return text, []
    try:
        words = shlex.split(text)
    except ValueError as error:
        raise ParameterError(f"--node {quoted(text)} is refused: {error}") from None
    if not words or shutil.which(words[0]) is None:
        if is_code(text):
            return text, []
        methods = f"a method ({', '.join(known)})" if known else "a method"
        raise ParameterError(f"--node {role}={text} is refused, allowed is {methods}, a library, law file or program")
    return "", words


def _drive(replay: Replay, run: Run, folder: Path, command: list[str]) -> Outcome:
    with progress_bar(f"replay of {replay.role}", run.duration) as progress:
        if not command:
            write_parameter_file(folder / PARAMETERS, run, node_parameters(run, folder, bag=False))
            outcome = drive_offline(run, progress)
            save(outcome.recording, folder / SIGNALS)  # which else the recorder does
            return outcome
        from ev_sim.running.processes import run_in_processes

        return run_in_processes(run, folder, False, progress, {replay.role: command})
