"""ev-stack compile: compiled code of every installed method, or of scenarios, so that no run has to wait for it."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from typing import Any

from ev_core.lockstep.finding import find_method
from ev_core.methods.former_names import chosen_by
from ev_core.methods.method_record import Method
from ev_core.methods.register import all_methods
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.frame import PLACES, places
from ev_msgs_py.contract.roles import ROLES
from ev_msgs_py.refusal import ParameterError, unknown_name
from ev_stack.command_line.refusal import Parser, refuse
from ev_stack.running.beforehand import (
    Unit,
    compile_units,
    of_reports,
    stepping,
    unit_of,
    unit_of_code,
    unit_of_method,
)
from ev_stack.scenarios.scenario import load_scenario

_PERIOD = 0.005  # [s], that all methods allow; compiled code is the same for all periods
_ABOUT = """
Compile what runs need, on all cores; what is compiled already is only looked for. Without names: every installed method
with its default parameters, and what steps it. Compiled code lies in your cache folder (docs/compiled_laws.md).
"""


def main(argv: list[str]) -> None:
    """ev-stack compile [SCENARIO | ROLE=METHOD ...]; exit status 1, and one line for each that cannot be compiled."""
    parser = Parser(prog="ev-stack compile", description=_ABOUT)
    parser.add_argument(
        "names", nargs="*", metavar="SCENARIO | ROLE=METHOD", help="default: everything"
    )
    given = parser.parse_args(argv)
    try:
        units = (
            [unit for name in given.names for unit in _named(name)] if given.names else everything()
        )
        errors = compile_units(units)
    except (ParameterError, OSError) as error:
        refuse(error)
    sys.exit("\n".join(errors) or None)


def _named(name: str) -> list[Unit]:
    role, _, method = name.partition("=")
    if method:
        if role not in ROLES:
            raise unknown_name("node", role, ROLES)
        # A former name may mean a present method with some of its switches on.
        former = chosen_by(role, method)
        found = find_method(role, method)
        units = [_by_default(found.with_switches_on(name for name in former if name != "method"))]
    else:
        played = [each for run in load_scenario(name).runs for each in run.configurations.values()]
        units = [*map(unit_of, played), *of_reports(played)]
    return [*filter(None, units), *stepping(in_nodes=True), *stepping(in_nodes=False)]


def everything() -> list[Unit]:
    """Units for all that steps methods, sensors and observers, and for all methods.

    Methods that share functions of one type are together.
    """
    methods: list[Method] = []
    for of_role in all_methods().values():
        for method in of_role.values():
            # Each switch alone; combinations of them are compiled when they are used.
            options = (method.with_switches_on([switch]) for switch in method.switches)
            methods += [method, *options]
    units = [_together([*filter(None, map(_by_default, group))]) for group in sharing(methods)]
    return [*units, *stepping(in_nodes=True), *stepping(in_nodes=False), *_behind_parts()]


def _by_default(method: Method) -> Unit | None:
    return unit_of_method(method, method.parameters(), Vehicle(), _PERIOD)


def _together(units: list[Unit]) -> Unit:
    """Some units as one, which one process compiles."""

    def make() -> None:
        for unit in units:
            unit.make()

    return Unit(units[0].name, lambda: all(unit.is_kept() for unit in units), make, units[0].key)


def sharing(methods: Iterable[Method]) -> list[list[Method]]:
    """The methods that are compiled, in groups that share functions of one type.

    What takes long comes first.
    """
    groups: dict[Any, list[Method]] = {}
    for method in methods:
        if method.law is None or not method.law.is_compilable:
            continue
        kind = (
            # Functions are compiled for types: one process makes those of a type once for the whole
            # group.
            (method.law.parameters, method.law.state) if method.law.heavy else method.law.function
        )
        groups.setdefault(kind, []).append(method)
    return sorted(groups.values(), key=_cost, reverse=True)


def _cost(group: list[Method]) -> tuple[bool, int, int]:
    """A rough order of how long methods take: whether they are heavy, how many they are, how much they read."""
    read = [places(signal) for signal in group[0].reads if signal in PLACES]
    assert group[0].law is not None
    return group[0].law.heavy, len(group), sum(map(len, read))


def _behind_parts() -> list[Unit]:
    """Sensors, faults, observers, and what reports need."""
    from ev_core.compiled.part import ROW_CODE  # numba is slow to import
    from ev_sim.driver.off_path import DISTANCES
    from ev_stack.batches.observer import OBSERVER

    return list(map(unit_of_code, (*ROW_CODE.values(), OBSERVER, DISTANCES)))
