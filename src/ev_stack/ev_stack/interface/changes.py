"""Changes of a scenario's file: the same keywords in every call of the Python interface.

How it works: `Changes` declares them, once. A call takes them as `**changes: Unpack[Changes]`,
which type checkers and editors complete; `listing_changes` writes them into its signature, which
help and notebooks show; `overrides` makes of them what the resolver of scenarios takes.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Mapping
from os import PathLike, fspath
from pathlib import Path
from typing import Any, TypedDict, TypeVar, Unpack

from ev_core.parameters.values import number_of
from ev_msgs_py.refusal import ParameterError, quoted, unknown_name
from ev_stack.scenarios.records import Overrides

Name = str | PathLike[str]  # or a path
C = TypeVar("C", bound=Callable[..., Any])


class Changes(TypedDict, total=False):
    """Changes of a scenario's file, as `ev_stack.run` describes them; None changes nothing."""

    method: Mapping[str, str] | None
    set: Mapping[str, Any] | None
    seed: int | None
    duration: float | str | None
    vehicle: Name | None
    params: Iterable[Name] | None
    cycle: Name | None


def listing_changes(call: C) -> C:
    """Show each keyword of `Changes` in the signature of a call that takes **changes."""
    signature = inspect.signature(call)
    # **changes makes room for the keywords that it stands for.
    own = [each for each in signature.parameters.values() if each.kind is not each.VAR_KEYWORD]
    keywords = [
        inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=kind)
        for name, kind in Changes.__annotations__.items()
    ]
    # help and notebooks read __signature__ before they look at the function itself.
    shown: Any = call
    shown.__signature__ = signature.replace(parameters=[*own, *keywords])
    return call


@listing_changes
def overrides(**changes: Unpack[Changes]) -> Overrides:
    """Make of changes what the resolver takes.

    ParameterError for a name in `set` without a dot, and for no duration; TypeError for a keyword
    that is none.
    """
    for name in changes:
        if name not in Changes.__annotations__:
            raise TypeError(str(unknown_name("keyword", name, Changes.__annotations__)))
    values: list[tuple[str, str, Any]] = []
    for node, method in (changes.get("method") or {}).items():
        values.append((node, "method", method))
    for place, value in (changes.get("set") or {}).items():
        node, _, parameter = place.partition(".")
        if not parameter:
            raise ParameterError(f"set: {quoted(place)} is refused, expected NODE.PARAMETER")
        values.append((node, parameter, value))
    files = [Path(path) for path in changes.get("params") or ()]
    vehicle, cycle = changes.get("vehicle"), changes.get("cycle")
    changed = Overrides(
        files, values, _seconds(changes.get("duration")), fspath(vehicle) if vehicle else None
    )
    return changed.with_seed(changes.get("seed")).with_cycle(
        None if cycle is None else fspath(cycle)
    )


def _seconds(duration: float | str | None) -> float | None:
    seconds = number_of(duration, "s") if isinstance(duration, str) else duration
    # True is an int to Python.
    is_number = isinstance(seconds, int | float) and not isinstance(seconds, bool)
    if duration is not None and not is_number:
        raise ParameterError(
            f"duration: {quoted(duration)} is refused, "
            "expected a number of seconds or such as '5 s'"
        )
    return seconds
