"""What makes a scenario another one than its file says, and that file another one than the defaults."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from ev_core.lockstep.configuration import Configuration, configure
from ev_msgs_py.contract.roles import ROLES
from ev_sim.scenarios.scenario import Run, Scenario

COMMAND_LINE, SCENARIO = "command line", "scenario"
EVERY_NODE = "every node"
_OF_THE_CAR = "vehicle."


@dataclass(frozen=True, slots=True)
class Difference:
    """A parameter that is not what it would be without its cause `by`: `value` in the place of `instead_of`.

    `instead_of` is what the scenario's own file says where the command line is the cause, else the default.
    """

    by: str
    node: str
    parameter: str
    value: Any
    instead_of: Any
    unit: str


def differences(driven: Scenario, own: Scenario) -> list[Difference]:
    """Those of the command line, then those of the scenario's file; `own` is the scenario without the command line.

    The car's parameters count where the command line changes them: its file gives all of them.
    """
    nodes: dict[Difference, list[str]] = {}
    for run, before in zip(driven.runs, own.runs, strict=True):
        for found in _of_run(run, before):
            key = Difference(found.by, "", found.parameter, _frozen(found.value), _frozen(found.instead_of), found.unit)
            nodes.setdefault(key, []).append(f"{run.name}/{found.node}")
    listed = [
        Difference(key.by, _together(members, driven), key.parameter, key.value, key.instead_of, key.unit)
        for key, members in nodes.items()
    ]
    return sorted(listed, key=lambda difference: difference.by)


def _of_run(run: Run, before: Run) -> Iterator[Difference]:
    for role, configuration in run.configurations.items():
        own, defaults = before.configurations.get(role), _defaults(configuration)
        scenarios = own.values() if own else defaults  # an optional role that the command line lets somebody play
        for entry in configuration.entries():
            name, value = entry.name, entry.default
            instead_of = scenarios.get(name, defaults[name])
            if value != instead_of:
                yield Difference(COMMAND_LINE, role, name, value, instead_of, entry.spec.unit)
            elif value != defaults[name] and not name.startswith(_OF_THE_CAR):
                yield Difference(SCENARIO, role, name, value, defaults[name], entry.spec.unit)


def _defaults(configuration: Configuration) -> dict[str, Any]:
    """What the parameters of a node would be if nothing but its method and its car were chosen."""
    given = {name: value for name, value in configuration.values().items() if name.startswith(_OF_THE_CAR)}
    given["method"] = configuration.method.name
    extra = type(configuration.extra) if configuration.extra is not None else None
    plain = configure(configuration.role, given, extra).values()
    return {**plain, "method": ROLES[configuration.role].default_method}


def _frozen(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


def _together(members: list[str], driven: Scenario) -> str:
    """The nodes in short: every node, a node of all runs, or each by its run."""
    roles = list(dict.fromkeys(name.rpartition("/")[2] for name in members))
    if len(members) != len(roles) * len(driven.runs):
        return ", ".join(members)
    return EVERY_NODE if len(roles) == len(driven.runs[0].configurations) else ", ".join(roles)
