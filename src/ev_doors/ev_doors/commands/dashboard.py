"""scripts/dashboard.sh: a local page with the signals, parameters and time of a running graph."""

from __future__ import annotations

import argparse
import asyncio
import os
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from importlib.util import find_spec

from ev_core.methods.offered import offered
from ev_msgs_py.refusal import quoted
from ev_nodes.stepping.stop_request import STOPPED
from ev_stack.command_line.numbers import PORT
from ev_stack.command_line.offered_commands import STUDIES
from ev_stack.command_line.refusal import Parser, refuse
from ev_stack.recording.outcome import RunFailed
from ev_stack.running.children import ends_with_us
from ev_stack.running.domain import free_domain, reserved_domains

# With these a run sends nothing that a page could show.
_NO_DDS = ("--offline", "--list", "--help", "-h")


def main(argv: list[str] | None = None) -> None:
    """scripts/dashboard.sh [SCENARIO [options of scripts/run.sh]]"""
    given, words = _arguments(argv)
    for package, what in (("rclpy", "ROS 2 (rclpy)"), ("tornado", "tornado")):
        if find_spec(package) is None:
            refuse(f"a dashboard needs {what}, which is not installed here")
    from ev_doors.dashboard.server import attached, listening

    try:
        with _domain(bool(words)) as domain:
            # before a run is started for a page that cannot be served
            sockets = listening(given.port)
            with _run_of(words, domain) as run:
                ended = asyncio.run(attached(given.namespace, domain, sockets, run))
                if run is not None and ended is None:  # Ctrl-C: the run prints that itself
                    run.send_signal(signal.SIGINT)
    except RunFailed as error:
        refuse(error)
    # The run has printed why; its status becomes ours, so a script sees it.
    if run is not None and run.returncode:
        sys.exit(run.returncode)
    if ended is None:
        print("stopped", file=sys.stderr)
        sys.exit(STOPPED)
    print(f"dashboard: {ended}")


def _arguments(argv: list[str] | None) -> tuple[argparse.Namespace, list[str]]:
    parser = Parser(
        prog="dashboard.sh",
        usage="dashboard.sh [--port N] [--namespace /NAME] [SCENARIO [options of run.sh]]",
        description=(
            "A page on this machine with live signals, the car from above, parameters and time."
            " Without a SCENARIO it attaches to the run that is under way (of several:"
            " ROS_DOMAIN_ID=N); with one it drives that, in real time unless --set"
            " plant.real_time_factor says otherwise."
        ),
        allow_abbrev=False,
    )
    parser.add_argument(
        "--port", type=PORT, default=8050, metavar="N", help="of the page, 0 for any; default 8050"
    )
    parser.add_argument(
        "--namespace",
        metavar="/NAME",
        help="of the graph; default: that of the run, or of each in turn",
    )
    given, words = parser.parse_known_args(argv)
    # argparse leaves what it does not know, and a scenario has no dash.
    if words and words[0].startswith("-"):
        parser.error(f"{quoted(words[0])} is not known; options of a run stand behind its SCENARIO")
    if words and words[0] in offered(STUDIES):
        parser.error(f"{words[0]} is a study: its runs are not on DDS: name a scenario")
    for word in _NO_DDS:
        if word in words:
            parser.error(f"{word} is refused: the page hears a run over DDS")
    return given, words


@contextmanager
def _domain(own: bool) -> Iterator[int]:
    """Find the domain for a run of our own, or that of the run under way.

    Raises RunFailed if no run or several runs are under way.
    """
    if own or os.environ.get("ROS_DOMAIN_ID"):
        with free_domain() as domain:
            yield domain
        return
    found = reserved_domains()
    if len(found) != 1:
        there = (
            f"runs are under way in the domains {', '.join(map(str, found))}"
            if found
            else "no run is under way"
        )
        raise RunFailed(
            f"{there}: {'ROS_DOMAIN_ID=N says which' if found else 'name a SCENARIO to drive one'}"
        )
    yield found[0]


@contextmanager
def _run_of(words: Sequence[str], domain: int) -> Iterator[subprocess.Popen | None]:
    """A run of our own as a child, which ends with the block; none without words."""
    if not words:
        yield None
        return
    scenario, *others = words
    command = [
        sys.executable,
        "-c",
        "from ev_stack.commands.program import main; main()",
        "run",
        scenario,
    ]
    run = subprocess.Popen(
        # In front of the user's own options, of which the last one counts.
        [*command, "--set", "plant.real_time_factor=1", *others],
        env={**os.environ, "ROS_DOMAIN_ID": str(domain)},
        preexec_fn=ends_with_us(),
        start_new_session=True,  # Ctrl-C is for us, and we pass it on once
    )
    try:
        yield run
    except BaseException:
        run.send_signal(signal.SIGINT)
        raise
    finally:
        # A second Ctrl-C does not leave the run alone while it stops its nodes.
        with suppress(KeyboardInterrupt):
            run.wait()
