"""Dataclasses of what a file states: all that they need, nothing else, each entry of its kind."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping
from dataclasses import MISSING, fields
from typing import Any, TypeVar

from ev_msgs_py.refusal import ParameterError, quoted, shown, unknown_name

T = TypeVar("T")
_KINDS: dict[str, tuple[str, tuple[type, ...]]] = {
    "int": ("a whole number", (int,)),
    # A whole number in a file may stand for a float.
    "float": ("a finite number", (int, float)),
    "str": ("a text", (str,)),
    "list": ("a list", (list,)),
    "Mapping": ("a mapping", (Mapping,)),
}


def mapping(what: str, content: Any) -> Mapping[str, Any]:
    """The content, ParameterError if it is no mapping."""
    if not isinstance(content, Mapping):
        raise ParameterError(f"{what} is {_shown(content)}, expected a mapping")
    return content


def refuse_unknown(what: str, names: Iterable[str], known: Collection[str]) -> None:
    """ParameterError for the first of some names that is not among the known ones."""
    for name in names:
        if name not in known:
            raise unknown_name(what, name, known)


def record(of: type[T], what: str, content: Any) -> T:
    """A dataclass of what a mapping states; records in it are made before."""
    stated, known = mapping(what, content), {each.name: each for each in fields(of)}  # type: ignore[arg-type]
    for name in stated:
        if name not in known:
            raise unknown_name(f"entry of {what}", str(name), known)
    for name, each in known.items():
        if name not in stated and each.default is MISSING and each.default_factory is MISSING:
            raise ParameterError(f"{what} lacks {name}")
    for name, value in stated.items():
        # The types of the fields are texts, such as list[float]: the modules of records postpone
        # annotations.
        kind, _, inner = str(known[name].type).removesuffix("]").partition("[")
        elements = value if kind == "list" and isinstance(value, list) else ()
        if not is_of(value, kind) or not all(is_of(each, inner) for each in elements):
            allowed = _allowed(kind) + (
                f", each element {_allowed(inner)}" if kind == "list" else ""
            )
            raise ParameterError(f"{name} of {what} is {_shown(value)}, expected {allowed}")
    return of(**stated)


def is_of(value: Any, kind: str) -> bool:
    """Return True if a value is of a kind; neither a switch nor an infinite one is a number."""
    if kind not in _KINDS:
        return type(value).__name__ == kind.removesuffix(" | None")
    if isinstance(value, float) and not math.isfinite(value):
        return False
    # True is an int in Python.
    return isinstance(value, _KINDS[kind][1]) and not isinstance(value, bool)


def _allowed(kind: str) -> str:
    return _KINDS.get(kind, _KINDS["Mapping"])[0]


def _shown(value: Any) -> str:
    return quoted(value) if isinstance(value, str) else shown(str(value))
