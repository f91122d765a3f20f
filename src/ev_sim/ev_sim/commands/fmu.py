"""ev-stack fmu: a car or a law as an FMU."""

from __future__ import annotations

import argparse
from collections.abc import Container
from pathlib import Path

from ev_msgs_py.contract.roles import ROLES, RoleKind
from ev_msgs_py.refusal import ParameterError
from ev_sim.command_line.options import add_overrides, overrides
from ev_sim.command_line.refusal import Parser, refuse
from ev_sim.fmu.content import Content
from ev_sim.fmu.export import write_fmu
from ev_sim.interface.driving import only_run

_ANSWERING = [name for name, role in ROLES.items() if role.kind is RoleKind.ANSWERS]


def main(argv: list[str] | None = None) -> None:
    """ev-stack fmu SCENARIO --out NAME.fmu [--law ROLE | --without ROLE,ROLE] [options]"""
    given = _arguments(argv)
    try:
        run = only_run(given.scenario, given.run, overrides(given))
        without = [] if given.law else given.without.split(",") if given.without else _played(run.configurations)
        write_fmu(Content(run, given.law, without), given.out)
    except (ParameterError, ImportError, OSError) as error:
        refuse(error)
    print(f"{given.law or 'car'} of {run.name}: {given.out}")


def _played(roles: Container[str]) -> list[str]:
    return [role for role in _ANSWERING if role in roles]


def _arguments(argv: list[str] | None) -> argparse.Namespace:
    parser = Parser(prog="ev-stack fmu", description=__doc__)
    parser.add_argument("scenario", help="name of a scenario, or path of your own")
    parser.add_argument("--run", default="", help="of a scenario with several runs")
    parser.add_argument("--out", type=Path, required=True, metavar="NAME.fmu", help="NAME becomes that of the model")
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--law", default="", metavar="ROLE", help="one role that answers, such as asr, on its own")
    what.add_argument(
        "--without", default="", metavar="ROLE,ROLE", help="the car without these; default: all that answer"
    )
    add_overrides(parser)
    return parser.parse_args(argv)
