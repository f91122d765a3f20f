"""Parameters as data.

How it works: a field of a frozen dataclass carries default, unit, range, description and source.
Everything that needs to know a parameter (ROS declaration, validation, YAML check, reference page)
is derived from the field, so a parameter is written down exactly once. A field that is a dataclass
itself is a group: its name stands before those of its parameters.
"""

import types
import typing
from collections.abc import Iterator
from dataclasses import Field, dataclass, field, fields, is_dataclass
from enum import IntEnum
from functools import cache
from typing import Any, TypeVar

from ev_msgs_py.arguments import checked

P = TypeVar("P")
_SPEC = "parameter"
_ASSUMED = "assumption"  # the source that is reproduced gives no value


class Choice(IntEnum):
    """Choices of a parameter: one of the members, numbered from zero in their order.

    Files, commands and ROS give a member by its name in small letters. A law compares with the
    member, `p.keep == Keep.SUM`, in Python and compiled alike.
    """

    @staticmethod
    def _generate_next_value_(name: str, start: int, count: int, last_values: list[Any]) -> int:
        return count

    @property
    def text(self) -> str:
        """The name outside of Python."""
        return self.name.lower()

    @classmethod
    def of(cls, text: str) -> "Choice":
        """The member with this name."""
        return {member.text: member for member in cls}[text]

    @classmethod
    def texts(cls) -> tuple[str, ...]:
        """The names of all members."""
        return tuple(member.text for member in cls)


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
    lateral: bool = False
    per_wheel: bool = False
    own: bool = False

    @property
    def allowed(self) -> str:
        """The allowed values in words, with the unit."""
        if self.choices:
            return "one of " + ", ".join(self.choices)
        unit = f" {self.unit}" if self.unit and self.unit != "1" else ""
        if self.low is None and self.high is None:
            return "any value of its type"
        if self.high is None:
            return f"at least {_in_words(self.low)}{unit}"
        if self.low is None:
            return f"at most {_in_words(self.high)}{unit}"
        return f"{_in_words(self.low)} to {_in_words(self.high)}{unit}"


_spec = checked(Spec)  # refuses what a law file declares wrongly


def _in_words(end: float | None) -> str:
    """An end of a range; whole numbers keep all their digits."""
    return f"{end:g}" if isinstance(end, float) else str(end)


def parameter(default: Any, *, about: str, source: str = _ASSUMED, **more: Any) -> Any:
    """Declare one field of a parameter dataclass; `more` are further fields of `Spec` by name.

    `low` and `high` are inclusive and in `unit` (SI, "1" for a pure number, empty for text and
    switches); for an array they hold for each element. `source` is where the default comes from.
    `read_only` parameters are fixed when a node starts. When left and right are exchanged,
    `lateral` parameters change their sign, and arrays `per_wheel` their order. Parameters `own` are
    declared by `own`. A default that is a `Choice` declares what else may be chosen.

    >>> from dataclasses import dataclass
    >>> from ev_core.law import parameter
    >>> @dataclass(frozen=True, slots=True)
    ... class Parameters:
    ...     gain: float = parameter(2.0, unit="N m s/rad", low=0.0, about="yaw moment over error")
    >>> Parameters().gain
    2.0
    """
    if isinstance(default, Choice):
        more["choices"] = type(default).texts()
    return field(default=default, metadata={_SPEC: _spec(about, source=source, **more)})


def is_declared(field: Field[Any]) -> bool:
    """Return whether a field of a dataclass is a declared parameter."""
    return _SPEC in field.metadata


def setting(default: Any, **about: Any) -> Any:
    """Declare a field as `parameter` does, without a source.

    Its value is chosen, or describes a thing.
    """
    return parameter(default, source="", **about)


def own(default: Any, **about: Any) -> Any:
    """Declare a `setting` for which everything that it describes states a value.

    No default can stand for that.
    """
    return setting(default, own=True, **about)


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
    """All parameters of a parameter dataclass, in order of declaration.

    Groups are flattened to dotted names.
    """
    if isinstance(of, type):
        return _entries_by_default(of, prefix)
    return tuple(_entries(of, prefix))


@cache
def _entries_by_default(of: type, prefix: str) -> tuple[Entry, ...]:
    return tuple(_entries(of(), prefix))


def _entries(of: Any, prefix: str) -> Iterator[Entry]:
    kind: type = type(of)
    hints = _type_hints(kind)
    for f in fields(of):
        value = getattr(of, f.name)
        if is_dataclass(value):
            yield from _entries(value, f"{prefix}{f.name}.")
            continue
        if isinstance(value, Choice):
            yield Entry(prefix + f.name, str, False, value.text, f.metadata[_SPEC])
            continue
        element, is_array = _element_type(hints[f.name])
        yield Entry(prefix + f.name, element, is_array, value, f.metadata[_SPEC])


@cache
def defaults(of: type[P]) -> P:
    """A parameter dataclass with all its defaults; it is frozen, so one does."""
    return of()


_type_hints = cache(typing.get_type_hints)


def _element_type(hint: Any) -> tuple[type, bool]:
    if typing.get_origin(hint) is tuple:
        return typing.get_args(hint)[0], True
    if isinstance(hint, types.GenericAlias):
        raise TypeError(
            f"a parameter is a number, a switch, a text or a tuple of one of them, not {hint}"
        )
    return hint, False


def flatten(instance: Any, prefix: str = "") -> dict[str, Any]:
    """Dotted names and values of a parameter dataclass, as `entries` have them.

    `build` makes the dataclass of them again.
    """
    found: dict[str, Any] = {}
    kind: type = type(instance)
    for name, _ in _names_and_choices(kind):
        value = getattr(instance, name)
        if type(value) is float:  # nearly all are
            found[prefix + name] = value
        elif is_dataclass(value):
            found |= flatten(value, f"{prefix}{name}.")
        else:
            found[prefix + name] = value.text if isinstance(value, Choice) else value
    return found


def number_tree(instance: Any) -> dict[str, Any]:
    """The numbers of a parameter dataclass as a tree: floats by name, groups as trees.

    A choice is its place among the choices, a switch 0 or 1. Free text and arrays, which are no
    numbers, are left out.
    """
    tree: dict[str, Any] = {}
    kind: type = type(instance)
    for name, choices in _names_and_choices(kind):
        value = getattr(instance, name)
        if type(value) is float:  # nearly all are
            tree[name] = value
        elif isinstance(value, str):
            # Code may have put a text where the declaration has a Choice.
            default = _default(kind, name)
            if isinstance(default, Choice):
                expected = type(default).__name__
                raise TypeError(f"{name} is the text {value}, expected a member of {expected}")
            if choices:
                tree[name] = float(choices.index(value))
        elif is_dataclass(value):
            tree[name] = number_tree(value)
        elif not isinstance(value, tuple):
            tree[name] = float(value)
    return tree


@cache
def _default(of: type, name: str) -> Any:
    """The default of a parameter."""
    return getattr(defaults(of), name)


@cache
def _names_and_choices(of: type) -> tuple[tuple[str, tuple[str, ...]], ...]:
    """Names of the parameters of a dataclass, and what those that are texts may be."""
    found: list[tuple[str, tuple[str, ...]]] = []
    for f in fields(of):
        choices = f.metadata[_SPEC].choices if is_declared(f) else ()
        found.append((f.name, choices))
    return tuple(found)
