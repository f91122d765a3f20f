"""Order of the roles within one step, derived from what they read and write."""

from __future__ import annotations

from collections.abc import Mapping
from graphlib import CycleError, TopologicalSorter

from ev_msgs_py.contract.roles import Role, RoleKind


class GraphError(ValueError):
    """The declared graph cannot be stepped; the message names the roles and signals concerned."""


def writers(roles: Mapping[str, Role]) -> dict[type, str]:
    """Which role writes each signal; GraphError if two roles write the same one."""
    by_signal: dict[type, str] = {}
    for role in roles.values():
        for signal in role.may_write:
            if signal in by_signal:
                raise GraphError(f"{signal.__name__} is written by both {by_signal[signal]} and {role.name}")
            by_signal[signal] = role.name
    return by_signal


def step_order(roles: Mapping[str, Role]) -> tuple[str, ...]:
    """Names of the roles that answer at once, each after everything that it reads; always in the same order.

    GraphError if a signal that is read is written by nobody, or if instant reads form a cycle.
    """
    by_signal = writers(roles)
    sorter: TopologicalSorter[str] = TopologicalSorter()
    for role in roles.values():
        for signal in role.reads:
            if signal not in by_signal:
                raise GraphError(f"{role.name} reads {signal.__name__}, which no role writes")
        if role.kind is RoleKind.ANSWERS:
            instant = (by_signal[signal] for signal in role.reads)
            sorter.add(role.name, *(name for name in instant if roles[name].kind is RoleKind.ANSWERS))
    try:
        return tuple(sorter.static_order())
    except CycleError as error:
        raise GraphError(f"roles wait for each other within one step: {' -> '.join(error.args[1])}") from None


def polling_order(roles: Mapping[str, Role], master: str) -> tuple[str, ...]:
    """Names of all roles in the order in which messages go from one to the next between two instants.

    The master speaks first, then those that answer; the others that integrate need the last of these answers.
    """
    integrating = (role.name for role in roles.values() if role.kind is RoleKind.INTEGRATES and role.name != master)
    return (master, *step_order(roles), *integrating)


def sequence(roles: Mapping[str, Role]) -> tuple[str, ...]:
    """Names of all roles in the order in which they speak within one step: first those that integrate."""
    integrating = (role.name for role in roles.values() if role.kind is RoleKind.INTEGRATES)
    return (*integrating, *step_order(roles))


def arrival_order(roles: Mapping[str, Role], master: str) -> tuple[str, ...]:
    """Names of all roles in the order in which they speak of an instant.

    As in `sequence`, but the master goes on to an instant only when the others that integrate are there.
    """
    others = (role for role in sequence(roles) if role != master and roles[role].kind is RoleKind.INTEGRATES)
    return (*others, master, *step_order(roles))
