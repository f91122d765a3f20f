"""Parameters as data: one frozen dataclass field carries default, unit, range, description and source.

Everything that needs to know a parameter (ROS declaration, validation, YAML check, reference page) is
derived from the field, so a parameter is written down exactly once.
"""

from __future__ import annotations

import dataclasses
import difflib
import math
import types
import typing
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, fields, is_dataclass
from functools import cache
from typing import Any, TypeVar

P = TypeVar("P")
_SPEC = "parameter"


class ParameterError(ValueError):
    """A parameter was refused; the message names the parameter, the value and what is allowed."""


@dataclass(frozen=True, slots=True)
class Spec:
    """Everything that is known about one parameter besides its name, type and default."""

    about: str
    unit: str = ""
    low: float | None = None
    high: float | None = None
    choices: tuple[str, ...] = ()
    source: str = ""
    read_only: bool = False

    @property
    def allowed(self) -> str:
        """The allowed values in words, with the unit."""
        if self.choices:
            return "one of " + ", ".join(self.choices)
        unit = f" {self.unit}" if self.unit and self.unit != "1" else ""
        if self.low is None and self.high is None:
            return "any value of its type"
        if self.high is None:
            return f"at least {self.low:g}{unit}"
        if self.low is None:
            return f"at most {self.high:g}{unit}"
        return f"{self.low:g} to {self.high:g}{unit}"


def parameter(
    default: Any,
    *,
    about: str,
    unit: str = "",
    low: float | None = None,
    high: float | None = None,
    choices: tuple[str, ...] = (),
    source: str = "",
    read_only: bool = False,
) -> Any:
    """Declare one field of a parameter dataclass.

    `low` and `high` are inclusive and in `unit` (SI, "1" for a pure number, empty for text and switches);
    for an array they hold for each element. `read_only` parameters are fixed when a node starts.
    """
    spec = Spec(about, unit, low, high, choices, source, read_only)
    return field(default=default, metadata={_SPEC: spec})


def group(of: type, **changed: Any) -> Any:
    """Declare a field that is itself a parameter dataclass; its parameters get dotted names."""
    return field(default_factory=lambda: of(**changed))


@dataclass(frozen=True, slots=True)
class Entry:
    """One parameter under its full dotted name, as ROS knows it."""

    name: str
    type: type
    is_array: bool
    default: Any
    spec: Spec


def entries(of: type | object, prefix: str = "") -> tuple[Entry, ...]:
    """All parameters of a parameter dataclass, groups flattened to dotted names, in order of declaration."""
    return tuple(_entries(of, prefix))


def _entries(of: Any, prefix: str) -> Iterator[Entry]:
    instance = of() if isinstance(of, type) else of
    hints = _type_hints(type(instance))
    for f in fields(instance):
        value = getattr(instance, f.name)
        if is_dataclass(value):
            yield from _entries(value, f"{prefix}{f.name}.")
            continue
        element, is_array = _element_type(hints[f.name])
        yield Entry(prefix + f.name, element, is_array, value, f.metadata[_SPEC])


@cache
def _type_hints(of: type) -> dict[str, Any]:
    return typing.get_type_hints(of)


def _element_type(hint: Any) -> tuple[type, bool]:
    if typing.get_origin(hint) is tuple:
        return typing.get_args(hint)[0], True
    if isinstance(hint, types.GenericAlias):
        raise TypeError(f"a parameter is a number, a switch, a text or a tuple of one of them, not {hint}")
    return hint, False


def check(entry: Entry, value: Any) -> Any:
    """The value as the dataclass keeps it (numbers as float where a float is meant, arrays as tuples).

    Raises ParameterError for a wrong type, a value out of range, NaN or infinity.
    """
    if entry.is_array:
        if isinstance(value, (str, bytes, Mapping)) or not isinstance(value, Iterable):
            raise _refused(entry, value, f"an array of {_type_word(entry.type)}")
        return tuple(_check_element(entry, element) for element in value)
    return _check_element(entry, value)


def _check_element(entry: Entry, value: Any) -> Any:
    spec = entry.spec
    if entry.type is float:
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise _refused(entry, value, f"a number, {spec.allowed}")
        try:
            number = float(value)
        except OverflowError:  # a whole number beyond all floats
            number = math.inf
        if not math.isfinite(number):
            raise _refused(entry, value, f"a finite number, {spec.allowed}")
        value = number
    elif entry.type is bool:
        if not isinstance(value, bool):
            raise _refused(entry, value, "true or false")
    elif entry.type is int:
        if isinstance(value, bool) or not isinstance(value, int):
            raise _refused(entry, value, f"a whole number, {spec.allowed}")
    elif not isinstance(value, str):
        raise _refused(entry, value, f"a text, {spec.allowed}")
    too_low = spec.low is not None and value < spec.low
    too_high = spec.high is not None and value > spec.high
    unknown = bool(spec.choices) and value not in spec.choices
    if too_low or too_high or unknown:
        raise _refused(entry, value, spec.allowed)
    return value


def _type_word(of: type) -> str:
    return {float: "numbers", int: "whole numbers", bool: "true or false", str: "texts"}[of]


def _refused(entry: Entry, value: Any, allowed: str) -> ParameterError:
    return ParameterError(f"parameter {entry.name}: {value!r} is refused, allowed is {allowed}")


def build(of: type[P], values: Mapping[str, Any], prefix: str = "") -> P:
    """An instance of a parameter dataclass from dotted names and values; what is not named keeps its default.

    Raises ParameterError for unknown names and bad values; nothing is built then.
    """
    return replaced(of(), values, prefix)


def replaced(instance: P, values: Mapping[str, Any], prefix: str = "") -> P:
    """A parameter dataclass with other values by dotted name; what is not named stays as it is.

    Raises ParameterError for unknown names and bad values; nothing is built then.
    """
    known = entries_by_name(type(instance), prefix)
    for name in values:
        if name not in known:
            raise unknown_name("parameter", name, known)
    checked = {name: check(known[name], value) for name, value in values.items()}
    return _replaced(instance, checked, prefix)


@cache
def entries_by_name(of: type, prefix: str = "") -> Mapping[str, Entry]:
    """All parameters of a parameter dataclass by their full dotted names."""
    return {entry.name: entry for entry in entries(of, prefix)}


def _replaced(instance: P, checked: Mapping[str, Any], prefix: str) -> P:
    if not any(name.startswith(prefix) for name in checked):
        return instance
    changed = {}
    for f in fields(instance):  # type: ignore[arg-type]
        name = prefix + f.name
        if is_dataclass(getattr(instance, f.name)):
            changed[f.name] = _replaced(getattr(instance, f.name), checked, f"{name}.")
        elif name in checked:
            changed[f.name] = checked[name]
    try:
        return dataclasses.replace(instance, **changed)  # type: ignore[type-var]
    except ParameterError as error:  # relations between parameters, checked in __post_init__
        raise ParameterError(f"{prefix}{error}" if prefix else str(error)) from None


def flatten(instance: Any, prefix: str = "") -> dict[str, Any]:
    """Dotted names and values of a parameter dataclass; the inverse of `build`."""
    return {entry.name: entry.default for entry in entries(instance, prefix)}


def number_tree(instance: Any) -> dict[str, Any]:
    """The numbers of a parameter dataclass as a tree: floats by name, groups as trees.

    A choice is its place among the choices, a switch 0 or 1. Free text and arrays, which are no numbers, are left out.
    """
    tree: dict[str, Any] = {}
    for f in fields(instance):
        value = getattr(instance, f.name)
        if is_dataclass(value):
            tree[f.name] = number_tree(value)
        elif isinstance(value, str):
            choices = f.metadata[_SPEC].choices
            if choices:
                tree[f.name] = float(choices.index(value))
        elif not isinstance(value, tuple):
            tree[f.name] = float(value)
    return tree


def unknown_name(kind: str, name: Any, known: Iterable[str]) -> ParameterError:
    """The error for a name that does not exist: it lists the known ones, the most similar first."""
    known = list(known)
    similar = difflib.get_close_matches(str(name), known, n=3)
    rest = [k for k in known if k not in similar]
    return ParameterError(f"unknown {kind} {name!r}; known: {', '.join([*similar, *sorted(rest)])}")
