"""Options of the commands that drive many runs, and what such a command prints at its end."""

from __future__ import annotations

import argparse
from collections.abc import Collection

from ev_stack.command_line.numbers import whole
from ev_stack.command_line.options import add_traceback
from ev_stack.command_line.paths import add_out
from ev_study.studies.workers import Workers


def add_driving(parser: argparse.ArgumentParser, name: str) -> None:
    """Declare on which workers, into which folder and whether once more a command drives."""
    where = parser.add_mutually_exclusive_group()
    where.add_argument(
        "--scheduler", metavar="tcp://HOST:PORT", help="a dask scheduler instead of this machine"
    )
    where.add_argument(
        "--workers",
        type=whole(1),
        metavar="N",
        help="worker processes here; default: one per core",
    )
    add_out(parser, name)
    parser.add_argument("--anew", action="store_true", help="drive again what was driven before")
    add_traceback(parser)


def add_choice(
    parser: argparse.ArgumentParser, option: str, names: Collection[str], metavar: str
) -> None:
    """Declare an option that chooses some of many."""
    parser.add_argument(
        option, nargs="+", choices=list(names), metavar=metavar, help="these only; default: all"
    )


def workers_of(given: argparse.Namespace) -> Workers:
    """Return the workers that a command line asks for."""
    return Workers(given.workers, given.scheduler)


def once_more(before: int) -> str:
    """Return the end of a line on runs: how many of them were driven by an earlier command."""
    return f", {before} of them driven before (--anew drives them again)" if before else ""
