"""Names that methods had in the last release, and go on having for one more.

This module is empty of names where nothing was renamed. A package adds its own by `formerly`, in
the module that registers the method.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ev_core.methods.register import load_installed_methods

# What to choose today, by role and former name: the method, and values of its parameters.
_FORMER: dict[tuple[str, str], dict[str, Any]] = {}


def formerly(role: str, name: str, now: str, **values: Any) -> None:
    """Let a name of the last release choose a method of today with these values."""
    _FORMER[role, name] = {"method": now, **values}


def chosen_by(role: str, name: Any) -> Mapping[str, Any]:
    """Method and values that a former name chooses; nothing for any other name."""
    load_installed_methods(role)
    # A name may be no text, as in a file with a mistake.
    return _FORMER.get((role, name), {}) if isinstance(name, str) else {}


def with_present_name(role: str, values: Mapping[str, Any]) -> dict[str, Any]:
    """The values of a role without a former name; those beside the name count before its own."""
    former = chosen_by(role, values.get("method"))
    if not former:
        return dict(values)
    return {**former, **values, "method": former["method"]}


def note_on(role: str, values: Mapping[str, Any]) -> str:
    """A line for a former name among the values of a role; empty for any other name."""
    name = values.get("method")
    former = dict(chosen_by(role, name))
    if not former:
        return ""
    now = former.pop("method")
    # A value beside the name counts before the one that the name stands for.
    chosen = [f"{key} {str(values.get(key, value)).lower()}" for key, value in former.items()]
    return (
        f"{role} method {name} is now {now}, here with {' and '.join(chosen)}; "
        "the old name goes with the next release"
    )
