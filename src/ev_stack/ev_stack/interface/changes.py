"""Changes of a scenario's file: the same keywords in every call of the Python interface.

How it works: `Changes` declares them, once. A call takes them as `**changes: Unpack[Changes]`,
which type checkers and editors complete; `checked` writes them into its signature, which help and
notebooks show; `overrides` makes of them what the resolver of scenarios takes.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from os import PathLike, fspath
from pathlib import Path
from typing import Annotated, Any, TypedDict, Unpack

from ev_core.parameters.values import number_of
from ev_msgs_py.arguments import checked
from ev_msgs_py.refusal import ParameterError, quoted
from ev_stack.scenarios.records import Overrides

Name = str | PathLike[str]  # or a path


class Changes(TypedDict, total=False):
    """Changes of a scenario's file, as `ev_stack.run` describes them; None changes nothing."""

    method: Annotated[Mapping[str, Name] | None, "{NODE: METHOD}, by names or law files"]
    set: Annotated[Mapping[str, Any] | None, "{'NODE.PARAMETER': VALUE}"]
    seed: int | None
    duration: Annotated[float | str | None, "a number of seconds or such as '5 s'"]
    vehicle: Name | None
    params: Iterable[Name] | None
    cycle: Name | None


@checked
def overrides(**changes: Unpack[Changes]) -> Overrides:
    """Make of changes what the resolver takes.

    ParameterError for a name in `set` without a dot, and for no duration; TypeError for a keyword
    that is none.
    """
    values: list[tuple[str, str, Any]] = []
    for node, method in (changes.get("method") or {}).items():
        values.append((node, "method", fspath(method)))
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
    if duration is not None and seconds is None:
        raise ParameterError(
            f"duration: {quoted(duration)} is refused, "
            "expected a number of seconds or such as '5 s'"
        )
    return seconds
