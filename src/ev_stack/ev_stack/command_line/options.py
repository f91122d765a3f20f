"""The command line of scripts/run.sh."""

from __future__ import annotations

import argparse
import shlex
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import yaml

from ev_core.methods.offered import offered
from ev_core.parameters.values import number_of
from ev_msgs_py.contract.roles import ROLES
from ev_msgs_py.refusal import ParameterError, quoted, unknown_name
from ev_stack.command_line.offered_commands import STUDIES, offered_commands
from ev_stack.command_line.paths import add_out
from ev_stack.command_line.refusal import Parser
from ev_stack.figures.saving import FORMATS, Print
from ev_stack.figures.sheets import COLUMN, TALLEST, WIDE
from ev_stack.scenarios.files import is_path, scenario_names
from ev_stack.scenarios.parameter_file import read_yaml
from ev_stack.scenarios.records import Overrides

TRACEBACK = "--traceback"


def arguments(argv: list[str] | None = None) -> argparse.Namespace:
    """Parse the command line.

    Argparse ends the process with status 2 for words it does not know.
    """
    parser = Parser(
        prog="run.sh",
        description=(
            "Run a scenario: every node its own process over DDS, unless an option changes this."
        ),
    )
    parser.add_argument(
        "scenario",
        nargs="?",
        action=_KnownName,
        help="name of a scenario, --list shows them, or path of your own",
    )
    parser.add_argument(
        "--run", action="append", default=[], metavar="NAME", help="of its runs only this one"
    )
    way = parser.add_mutually_exclusive_group()
    way.add_argument("--offline", action="store_true", help="no DDS, one process")
    way.add_argument("--in-process", action="store_true", help="all nodes in one process, over DDS")
    parser.add_argument(
        "--realtime", action="store_true", help="by the wall clock instead of in lockstep"
    )
    add_overrides(parser)
    add_metrics(parser, "besides those of the scenario")
    add_outputs(parser)
    parser.add_argument(
        "--node",
        action="append",
        default=[],
        metavar="NODE=COMMAND",
        help="your own node in the place of ours",
    )
    parser.add_argument(
        "--processor",
        action="append",
        default=[],
        metavar="NODE=PROCESSOR",
        help="a law as a program on aarch64 or arm (emulated), or by a command; drives without DDS",
    )
    add_out(parser, "SCENARIO")
    parser.add_argument(
        "--no-record", action="store_true", help="no bag; signals, metrics and figures all the same"
    )
    add_traceback(parser)
    parser.add_argument(
        "--list", action="store_true", help="show scenarios and methods, one line each"
    )
    given = parser.parse_args(argv)
    given.command = command_of(sys.argv[1:] if argv is None else argv)
    if not given.list and given.scenario is None:
        parser.error("which scenario? --list shows them")
    if given.processor:
        if given.in_process or given.realtime or given.node:
            parser.error(
                "--processor drives without DDS: leave out --in-process, --realtime and --node"
            )
        # Without DDS, whatever else is asked for.
        given.offline = True
    if given.offline and given.realtime:
        parser.error("--realtime needs DDS: leave out --offline")
    if given.node and (given.offline or given.in_process):
        parser.error("--node starts a process: leave out --offline and --in-process")
    return given


def driven_names() -> tuple[str, ...]:
    """The names behind `ev-stack run`: of all scenarios, studies and reviews."""
    return (*scenario_names(), *sorted(offered(STUDIES)), *offered_commands().reviews)


class _KnownName(argparse.Action):
    """Refuses an unknown name before its options, which may be those of what is meant."""

    def __call__(self, parser: Any, given: Any, name: Any, option: str | None = None) -> None:
        """ParameterError for what is neither a path nor the name of a scenario or a command."""
        if name is not None and not is_path(name):
            # Only now: the names come from folders and from other packages.
            known = driven_names()
            if name not in known:
                raise unknown_name("scenario, study or review", name, known)
        given.scenario = name


def add_traceback(parser: argparse.ArgumentParser) -> None:
    """Declare the option that `run_scenario.main` looks for."""
    parser.add_argument(
        TRACEBACK, action="store_true", help="how Python came to an error, before its line"
    )


def add_overrides(parser: argparse.ArgumentParser) -> None:
    """Declare the options that `overrides` reads."""
    parser.add_argument(
        "--method", action="append", default=[], metavar="NODE=NAME", help="method of a node"
    )
    parser.add_argument(
        "--cycle",
        metavar="NAME",
        help="another speed cycle: a CSV file, or a name in config/cycles",
    )
    add_changes(parser)


def add_changes(parser: argparse.ArgumentParser) -> None:
    """Declare those that leave methods and cycle as they are."""
    parser.add_argument(
        "--vehicle", metavar="FILE", help="another car: a complete vehicle file, or a name"
    )
    parser.add_argument(
        "--params",
        action="append",
        default=[],
        metavar="FILE",
        type=Path,
        help="more ROS parameters",
    )
    parser.add_argument(
        "--set", action="append", default=[], metavar="NODE.PARAM=VALUE", help="one parameter"
    )
    parser.add_argument("--seed", type=int, metavar="N", help="seed of everything random")
    parser.add_argument(
        "--duration", type=_seconds, metavar="S", help="simulated time of every run"
    )


def _seconds(text: str) -> float:
    found = number_of(text, "s")
    try:
        return float(text) if found is None else found
    except ValueError:
        allowed = "expected a number of seconds or such as '5 s'"
        raise argparse.ArgumentTypeError(f"{quoted(text)} is refused, {allowed}") from None


def add_metrics(parser: argparse.ArgumentParser, default: str) -> None:
    """Declare the option that chooses metrics."""
    parser.add_argument(
        "--metrics",
        default="",
        metavar="NAME,NAME",
        help=f"docs/metrics.md, or 'NAME [UNIT] = EXPRESSION'; {default}",
    )


def add_outputs(parser: argparse.ArgumentParser) -> None:
    """Declare the options of what a run or a study leaves behind besides its summary."""
    parser.add_argument(
        "--figures", type=_formats, default=(), metavar="pdf,svg", help="figures also for print"
    )
    parser.add_argument(
        "--width",
        type=float,
        choices=(COLUMN, WIDE),
        help=(
            "of figures for print [inch]: a column (default) or a page of a paper; none is taller"
            f" than {TALLEST:g}"
        ),
    )
    parser.add_argument(
        "--panels",
        metavar="NAME,NAME",
        help=(
            "only these in print: FIGURE, PANEL or FIGURE.PANEL with * and ?, where PANEL is its"
            " title, as yaw_rate"
        ),
    )
    parser.add_argument(
        "--no-report", action="store_true", help="neither report.html nor PNG figures"
    )


def printing(given: argparse.Namespace) -> Print:
    """Options for print; ParameterError for details without --figures."""
    # They have no default in the parser, where a given one could not be told apart from it.
    for option in ("width", "panels"):
        if getattr(given, option) is not None and not given.figures:
            raise ParameterError(f"--{option} is about figures for print: add --figures pdf or svg")
    return Print(
        given.figures, given.width or COLUMN, tuple(given.panels.split(",")) if given.panels else ()
    )


def _formats(text: str) -> tuple[str, ...]:
    formats = tuple(dict.fromkeys(text.split(",")))
    if not set(FORMATS).issuperset(formats):
        raise argparse.ArgumentTypeError(f"{quoted(text)} is refused, expected pdf, svg or pdf,svg")
    return formats


def command_of(words: Sequence[str]) -> str:
    """The line for a shell that does the same again."""
    return shlex.join(["scripts/run.sh", *words])


def own_nodes(given: argparse.Namespace) -> dict[str, list[str]]:
    """Commands by role of the nodes that take the place of ours.

    Raises ParameterError, in one line, for unknown roles.
    """
    commands = {}
    for word in given.node:
        node, command = _split(word, "=", "--node", "NODE=COMMAND")
        if node not in ROLES:
            raise unknown_name("node", node, ROLES)
        try:
            commands[node] = shlex.split(command)
        except ValueError as error:
            raise ParameterError(f"--node {quoted(word)} is refused: {error}") from None
    return commands


def processors(given: argparse.Namespace) -> dict[str, str]:
    """Processors, or commands of programs, by the role that runs there."""
    return dict(_split(word, "=", "--processor", "NODE=PROCESSOR") for word in given.processor)


def overrides(given: argparse.Namespace) -> Overrides:
    """Changes of the command line.

    Raises ParameterError, in one line, for words without NODE, name or =.
    """
    values: list[tuple[str, str, Any]] = []
    for word in getattr(given, "method", ()):
        node, name = _split(word, "=", "--method", "NODE=NAME")
        values.append((node, "method", name))
    for word in given.set:
        place, value = _split(word, "=", "--set", "NODE.PARAM=VALUE")
        # At the first dot: names of parameters have dots themselves.
        node, parameter = _split(place, ".", "--set", "NODE.PARAM=VALUE")
        values.append((node, parameter, _parsed(value)))
    if getattr(given, "realtime", False):
        # Behind all --set, so that the option counts where both are given.
        values.append(("*", "mode", "realtime"))
    changed = Overrides(given.params, values, given.duration, given.vehicle)
    return changed.with_seed(given.seed).with_cycle(getattr(given, "cycle", None))


def _split(word: str, mark: str, option: str, form: str) -> tuple[str, str]:
    left, found, right = word.partition(mark)
    if not (left and found and right):
        raise ParameterError(f"{option} {quoted(word)} is refused, expected {form}")
    return left, right


def _parsed(text: str) -> Any:
    """A value as a parameter file would read it."""
    try:
        return read_yaml(text)
    except yaml.YAMLError:
        raise ParameterError(f"--set: {quoted(text)} is no YAML value") from None
