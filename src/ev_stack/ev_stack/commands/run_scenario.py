"""The command scripts/run.sh. What drives and draws is imported when it is needed, so that help comes at once."""

from __future__ import annotations

import io
import math
import os
import resource
import sys
import traceback
from pathlib import Path

from ev_core.methods.offered import offered, offered_module
from ev_core.methods.register import all_methods, not_loaded
from ev_msgs_py.contract.fields import SignalError
from ev_msgs_py.refusal import ParameterError, first_line, shown
from ev_nodes.stepping.stop_request import KEPT
from ev_stack.command_line.offered_commands import STUDIES, offered_commands
from ev_stack.command_line.options import TRACEBACK, arguments
from ev_stack.command_line.refusal import refuse
from ev_stack.recording.outcome import RunFailed
from ev_stack.scenarios.about import describe_scenario
from ev_stack.scenarios.files import scenario_names

_NOT_READ = 141  # the status of a command with a closed output
# bytes, of the largest one, the compiler's, with what it needs while it is loaded
_OF_A_LIBRARY = 300e6


def main(argv: list[str] | None = None) -> None:
    """scripts/run.sh SCENARIO [options]"""
    words = sys.argv[1:] if argv is None else argv
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal may know ASCII only
    try:
        if words and words[0] in offered(STUDIES):
            drive_study(words)
            return
        if words and words[0] in offered_commands().reviews:
            offered_commands().reviews[words[0]].load()(words[1:])
            return
        given = arguments(words)
        if given.list:
            print_list()
        else:
            from ev_stack.commands.drive_scenario import drive_scenario

            drive_scenario(given)
        # Here, where it is caught that the reader has gone; Python's own flush at the end is not.
        sys.stdout.flush()
    # the reader, such as `head`, has seen enough; at its end Python would write the rest again
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(_NOT_READ)
    except (ParameterError, SignalError, RunFailed, OSError, MemoryError, ImportError) as error:
        # By the words, for the options may not have been parsed.
        if TRACEBACK in words:
            traceback.print_exc()
        if _lacks_memory(error):
            KEPT.append(error)  # half-loaded libraries would crash in Python's own end
            refuse(f"out of memory: {first_line(error)}".removesuffix(": "))
        if isinstance(error, ImportError):
            raise
        refuse(error)


def drive_study(words: list[str]) -> None:
    """Drive the study that the first word names.

    Raises RunFailed if no package is installed that drives studies.
    """
    study = offered_commands().study
    if study is None:
        raise RunFailed(f"{words[0]} needs the package ev_study, which is not installed here")
    study.load()(words)


def list_all(argv: list[str]) -> None:
    """ev-stack list"""
    main(["--list", *argv])


def _lacks_memory(error: BaseException) -> bool:
    """Return True for a lack of memory, which an unloadable library reports in its own words."""
    cause: BaseException | None = error
    while cause is not None:
        if isinstance(cause, MemoryError):
            return True
        cause = cause.__cause__ or cause.__context__
    # An OSError with a number, such as that of a missing file, has a cause of its own.
    of_a_library = isinstance(error, ImportError) or (
        isinstance(error, OSError) and error.errno is None
    )
    return of_a_library and free_memory() < _OF_A_LIBRARY


def free_memory() -> float:
    """Memory that this process may still take, by its own limit and by what the machine has [bytes]."""
    limit, _ = resource.getrlimit(resource.RLIMIT_AS)
    # The first number of statm is the size of the address space, which RLIMIT_AS limits, in pages.
    taken = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    own = math.inf if limit == resource.RLIM_INFINITY else limit - taken
    machine = dict(line.split(":") for line in Path("/proc/meminfo").read_text().splitlines())
    free = sum(int(machine[name].split()[0]) * 1024 for name in ("MemAvailable", "SwapFree"))
    return min(own, free)


def print_list() -> None:
    """Scenarios and methods, one line each."""
    print("scenarios")
    for name in scenario_names():
        print(f"  {shown(name):24} {shown(describe_scenario(name))}")
    print("studies, of many runs (scripts/run.sh STUDY --help)")
    for name in sorted(offered(STUDIES)):
        print(f"  {name:24} {offered_module(STUDIES, 'study', name).ABOUT}")
    print("reviews of runs, and of what the sources published (scripts/run.sh NAME --help)")
    for name, review in offered_commands().reviews.items():
        print(f"  {name:24} {review.about}")
    for line in not_loaded():
        print(f"not loaded: {line}")
    for role, methods in all_methods().items():
        print(f"methods of {role}")
        for name, method in methods.items():
            print(f"  {name:24} {method.about}")
