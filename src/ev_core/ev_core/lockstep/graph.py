"""Order of the roles within one step, derived from what they read and write.

How it works: a role that integrates has its output for an instant at once, since that follows from
the instant before. A role that answers comes after all roles that write what it reads.
`check_graph` holds configured nodes against each other before a run.
"""

from __future__ import annotations

from collections.abc import Mapping
from graphlib import CycleError, TopologicalSorter
from typing import Any

from ev_core.lockstep.configuration import Configuration
from ev_core.methods.former_names import chosen_by
from ev_core.methods.hooks import SAME
from ev_core.parameters.declaration import flatten
from ev_msgs_py.contract.roles import Role, RoleKind
from ev_msgs_py.refusal import ParameterError

# The common parameters of which all nodes have the same value.
_SHARED = ("control_period", "mode", "vehicle")


class GraphError(ValueError):
    """The declared graph cannot be stepped; the message names the roles and signals concerned."""


def writers(roles: Mapping[str, Role]) -> dict[type, str]:
    """The writing role of each signal; GraphError if two roles write the same one."""
    by_signal: dict[type, str] = {}
    for role in roles.values():
        for signal in role.may_write:
            if signal in by_signal:
                raise GraphError(
                    f"{signal.__name__} is written by both {by_signal[signal]} and {role.name}"
                )
            by_signal[signal] = role.name
    return by_signal


def step_order(roles: Mapping[str, Role]) -> tuple[str, ...]:
    """Names of the roles that answer at once, each after everything that it reads.

    The order is always the same. GraphError if no role writes a signal that is read, or if instant
    reads form a cycle.
    """
    by_signal = writers(roles)
    sorter: TopologicalSorter[str] = TopologicalSorter()
    for role in roles.values():
        for signal in role.reads:
            if signal not in by_signal:
                raise GraphError(f"{role.name} reads {signal.__name__}, which no role writes")
        # A role that integrates needs no place in the order: its output is there already.
        if role.kind is RoleKind.ANSWERS:
            instant = (by_signal[signal] for signal in role.reads)
            sorter.add(
                role.name, *(name for name in instant if roles[name].kind is RoleKind.ANSWERS)
            )
    try:
        return tuple(sorter.static_order())
    except CycleError as error:
        raise GraphError(
            f"roles wait for each other within one step: {' -> '.join(error.args[1])}"
        ) from None


def polling_order(roles: Mapping[str, Role], master: str) -> tuple[str, ...]:
    """Names of all roles in the order in which messages go between two instants.

    The master publishes first, then those that answer; the others that integrate need the last of
    these answers.
    """
    integrating = (
        role.name
        for role in roles.values()
        if role.kind is RoleKind.INTEGRATES and role.name != master
    )
    return (master, *step_order(roles), *integrating)


def sequence(roles: Mapping[str, Role]) -> tuple[str, ...]:
    """Names of all roles in the order in which they publish within one step.

    Those that integrate come first.
    """
    integrating = (role.name for role in roles.values() if role.kind is RoleKind.INTEGRATES)
    return (*integrating, *step_order(roles))


def arrival_order(roles: Mapping[str, Role], master: str) -> tuple[str, ...]:
    """Names of all roles in the order in which they publish an instant.

    As in `sequence`, but the master goes on to an instant only when the others that integrate are
    there.
    """
    others = (
        role
        for role in sequence(roles)
        if role != master and roles[role].kind is RoleKind.INTEGRATES
    )
    return (*others, master, *step_order(roles))


def check_graph(configurations: Mapping[str, Configuration]) -> None:
    """ParameterError if the configured nodes do not fit together.

    Nodes share one control period, one mode and one vehicle, what a method reads must be written by
    the others, and the methods and values that it requires must be chosen, except where a role is
    played by a recording.
    """
    _refuse_different_nodes(configurations)
    written: set[type] = set()
    for configuration in configurations.values():
        written.update(configuration.method.writes)
    for configuration in configurations.values():
        method = configuration.method
        for signal in method.inputs:
            if signal not in written:
                names = ", ".join(sorted(each.method.name for each in configurations.values()))
                raise ParameterError(
                    f"{configuration.role} method {method.name} reads {signal.__name__}, "
                    f"which none of the chosen methods writes ({names})"
                )
        for what, needed in method.requires.items():
            if needed == SAME:
                needed = configuration.values()[what.partition(".")[2]]
            if lacks := _lacks(configurations, what, needed):
                raise ParameterError(f"{configuration.role} method {method.name} requires {lacks}")


def _lacks(configurations: Mapping[str, Configuration], what: str, needed: Any) -> str:
    """Name what is needed of a role and what is found instead; empty if the need is met."""
    role, _, parameter = what.partition(".")
    other = configurations.get(role)
    if other is None:
        return f"{what if parameter else f'{role} method'} {_as_yaml(needed)}, but None is chosen"
    # Recorded signals are as they are, whatever made them.
    if other.method.plays_back:
        return ""
    if not parameter:
        # A law of another package may still require a method by its former name.
        for name, value in chosen_by(role, needed).items():
            part = role if name == "method" else f"{role}.{name}"
            if lacks := _lacks(configurations, part, value):
                return lacks
        needed = chosen_by(role, needed).get("method", needed)
        chosen = other.method.name
        return "" if chosen == needed else f"{role} method {needed}, but {chosen} is chosen"
    values = other.values()
    if parameter not in values:
        found = f"{role} method {other.method.name} does not have it"
    elif values[parameter] != needed:
        found = f"{_as_yaml(values[parameter])} is chosen"
    else:
        return ""
    return f"{what} {_as_yaml(needed)}, but {found}"


def _refuse_different_nodes(configurations: Mapping[str, Configuration]) -> None:
    first = next(iter(configurations.values())).common
    for shared in _SHARED:
        parts = {role: getattr(each.common, shared) for role, each in configurations.items()}
        # Cars are compared as a whole: to flatten each of them would take a tenth of a short run.
        if all(part == getattr(first, shared) for part in parts.values()):
            continue
        for name in flatten(first):
            values = {role: flatten(each.common)[name] for role, each in configurations.items()}
            if name.partition(".")[0] == shared and len(set(values.values())) > 1:
                given = ", ".join(f"{role} {value}" for role, value in values.items())
                raise ParameterError(f"{name} differs between nodes: {given}; expected one for all")


def _as_yaml(value: Any) -> str:
    """A value as a parameter file has it."""
    return str(value).lower() if isinstance(value, bool) else str(value)
