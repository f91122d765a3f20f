"""A car or its laws for other programs: a C library, an FMU."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from ev_msgs_py.refusal import ParameterError
from ev_stack.command_line.options import add_overrides, overrides
from ev_stack.command_line.paths import add_out
from ev_stack.command_line.refusal import Parser, refuse

if TYPE_CHECKING:
    from ev_doors.export.content import Content


def export_library(argv: list[str]) -> None:
    """ev-stack export SCENARIO --target TARGET --out DIR [--only ROLE,ROLE] [options]"""
    from ev_doors.export.library import write_library
    from ev_doors.export.targets import TARGETS, target_of

    parser = _of_export("export", "a car or its laws as a C library")
    parser.add_argument("--target", required=True, metavar="TARGET", help=", ".join(TARGETS))
    parser.add_argument(
        "--name", default="", help="names in C begin with evs_NAME; default: run and roles"
    )
    add_out(parser)
    given = parser.parse_args(argv)
    try:
        target = target_of(given.target)
        content = _content(given)
        name = given.name or "_".join([content.run.name, *_words(given.only)])
        write_library(content, name, target, given.out)
    except (ParameterError, OSError) as error:
        refuse(error)
    print(
        f"{name}: {', '.join(content.roles)} for {target.name} in {given.out}, hash"
        f" {content.digest[:12]}"
    )


def export_fmu(argv: list[str]) -> None:
    """ev-stack fmu SCENARIO --out NAME.fmu [--only ROLE,ROLE | --without ROLE,ROLE] [options]"""
    from ev_doors.export.fmu import TARGETS, VERSIONS, write_fmu
    from ev_doors.export.targets import target_of

    parser = _of_export("fmu", "a car or its laws as an FMU for co-simulation")
    parser.add_argument(
        "--fmi", type=int, choices=VERSIONS, default=VERSIONS[0], help="version of FMI; default: 2"
    )
    parser.add_argument(
        "--target",
        default=",".join(TARGETS),
        metavar="TARGET,TARGET",
        help="what it runs on; default: %(default)s",
    )
    parser.add_argument(
        "--out", type=Path, required=True, metavar="NAME.fmu", help="NAME becomes that of the model"
    )
    given = parser.parse_args(argv)
    try:
        # A target that is named twice is built once: an FMU has one library for each.
        targets = [target_of(name) for name in dict.fromkeys(given.target.split(","))]
        content = _content(given)
        write_fmu(content, given.fmi, targets, given.out)
    except (ParameterError, OSError) as error:
        refuse(error)
    print(f"{given.out}: {', '.join(content.roles)} for {given.target}, hash {content.digest[:12]}")


def _of_export(command: str, about: str) -> Parser:
    """Options by which a run and its roles are chosen."""
    parser = Parser(prog=f"ev-stack {command}", description=f"ev-stack {command}: {about}.")
    parser.add_argument("scenario", help="name of a scenario, or path of your own")
    parser.add_argument("--run", default="", help="of a scenario with several runs")
    what = parser.add_mutually_exclusive_group()
    what.add_argument(
        "--only", default="", metavar="ROLE,ROLE", help="these roles, such as asr; default: all"
    )
    what.add_argument(
        "--without", default="", metavar="ROLE,ROLE", help="all but these; their answers are inputs"
    )
    add_overrides(parser)
    return parser


def _words(text: str) -> list[str]:
    return text.split(",") if text else []


def _content(given: Namespace) -> Content:
    from ev_doors.export.content import Content
    from ev_stack.interface.driving import only_run

    run = only_run(given.scenario, given.run, overrides(given))
    return Content(run, _words(given.only), _words(given.without))
