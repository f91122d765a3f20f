"""What installed packages offer: methods by entry points of the group ev_stack.methods, named after their roles."""

from __future__ import annotations

from functools import cache
from importlib.metadata import entry_points

from ev_msgs_py.contract.roles import ROLES
from ev_msgs_py.parameters.shown import quoted

_GROUP = "ev_stack.methods"


@cache
def load_installed_methods(role: str) -> tuple[str, ...]:
    """Import what is offered for a role, and say in one line each what cannot be: it must not keep others from running.

    Only those of the role, because a plant takes longer to import than a node to start.
    """
    failed = []
    for entry_point in entry_points(group=_GROUP, name=role):
        try:
            entry_point.load()
        except Exception as error:  # whatever somebody's module raises
            failed.append(f"{entry_point.value}: {type(error).__name__}: {' '.join(str(error).split())}")
    return tuple(failed)


def not_loaded() -> tuple[str, ...]:
    """Everything that is offered and cannot be had, one line each: what fails, and what is offered for no role."""
    nobody = [point for point in entry_points(group=_GROUP) if point.name not in ROLES]
    lines = [
        f"{point.value}: offered for {quoted(point.name)}, which is no role: {', '.join(ROLES)}" for point in nobody
    ]
    return (*lines, *(line for role in ROLES for line in load_installed_methods(role)))
