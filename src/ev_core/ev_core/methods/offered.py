"""Modules that packages offer by entry points, besides methods.

They are reports, studies, sources and estimators.
"""

from __future__ import annotations

from functools import cache
from importlib import import_module
from types import ModuleType

from ev_core.parameters.data_file import entry_points
from ev_msgs_py.refusal import ParameterError, quoted, unknown_name


@cache
def offered(group: str) -> dict[str, str]:
    """The modules of a group of entry points by name.

    ParameterError if two packages offer something by one name.
    """
    found: dict[str, str] = {}
    for point in entry_points(group=group):
        if found.setdefault(point.name, point.value) != point.value:
            raise ParameterError(
                f"{group} {quoted(point.name)} is offered by {found[point.name]} and by "
                f"{point.value}, expected one"
            )
    return found


def offered_module(group: str, kind: str, name: str) -> ModuleType:
    """The module of a name.

    The ParameterError lists the known names, or why the module is not loaded.
    """
    modules = offered(group)
    if name not in modules:
        raise unknown_name(kind, name, modules)
    try:
        return import_module(modules[name])
    except Exception as error:  # a user's module may raise any error
        raise ParameterError(
            f"{kind} {name}: {modules[name]} is not loaded: {type(error).__name__}: {error}"
        ) from error
