"""ev-stack COMMAND ...: everything that can be done from a shell, under one name."""

from __future__ import annotations

import fcntl
import os
import signal
import sys
from collections.abc import Sequence
from importlib.metadata import version

from ev_msgs_py.refusal import quoted, unknown_name
from ev_nodes.stepping.stop_request import (
    KEPT,
    end,
    end_stopped,
    interrupt,
    interrupt_destructors,
    let_in,
    loading,
    turn_deaf,
    was_interrupted,
)
from ev_stack.command_line.offered_commands import offered_commands
from ev_stack.command_line.refusal import refuse


def main() -> None:
    """ev-stack COMMAND [options]"""
    try:
        open_closed_streams()
        interrupt_destructors()
        signal.signal(signal.SIGTERM, interrupt)
        let_in()  # scripts/run.sh holds signals back until here, where they are one line
        perform(sys.argv[1:])
    except BaseException as error:  # while a command is loaded as well, which takes half a second
        made_by_ctrl_c = was_interrupted() and not (
            isinstance(error, SystemExit) and not error.code
        )
        if not (isinstance(error, KeyboardInterrupt) or made_by_ctrl_c):
            raise
        end_stopped()
    finally:
        turn_deaf()
        error = sys.exception()
        if KEPT and (error is None or isinstance(error, SystemExit)):
            end(error.code if error else None)


def open_closed_streams() -> None:
    """Connect each closed standard stream to /dev/null, so that what is printed there is lost and nothing else.

    The number of a closed stream goes to the next file that is opened: the shell of scripts/run.sh
    reads its script as number 2 where that was closed. So an output that cannot be written counts
    as closed.
    """
    for number, name, mode in ((0, "stdin", "r"), (1, "stdout", "w"), (2, "stderr", "w")):
        try:
            access = fcntl.fcntl(number, fcntl.F_GETFL) & os.O_ACCMODE
        except OSError:
            access = None
        if access is None or (mode == "w" and access == os.O_RDONLY):
            nothing = os.open(os.devnull, os.O_RDWR)
            if nothing != number:
                os.dup2(nothing, number)
                os.close(nothing)
            setattr(sys, name, os.fdopen(number, mode, closefd=False))


def perform(words: Sequence[str]) -> None:
    """Do what the words of a command line ask for; SystemExit, KeyboardInterrupt."""
    if not words or words[0] in ("-h", "--help"):
        print("ev-stack COMMAND [options], ev-stack --version; COMMAND is one of")
        for name, command in offered_commands().commands.items():
            print(f"  {name:10} {command.about}")
        for line in offered_commands().not_loaded:
            print(f"not loaded: {line}")
        return
    if words[0] == "--version":
        print(f"ev-stack {version('ev_stack')}")
        return
    with loading():
        commands = offered_commands().commands
    if words[0] not in commands:
        with loading():
            from ev_stack.command_line.options import driven_names
        if words[0] in driven_names():
            why = f"{quoted(words[0])} is no command: ev-stack run {words[0]}"
        else:
            why = str(unknown_name("command", words[0], (*commands, *driven_names())))
        print(f"ev-stack: {why}", file=sys.stderr)
        sys.exit(2)
    try:
        with loading():
            perform_command = commands[words[0]].load()
        perform_command(list(words[1:]))
    except OSError as error:  # such as too many open files while it is loaded
        refuse(error)
