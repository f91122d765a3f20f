"""Declared records: every number that an object keeps has a name, a unit and a start value, once.

How it works: a record is a dataclass with slots; its fields are made by `entry`, `per_wheel`,
`series`, `row`, `part` and `each_wheel`. Python works on its instances; compiled code on the same
numbers in one row of float64, by the same names. `places` walks the numbers of a record in the
order of this row, for all that goes number by number. Only the layout and `numbers`, which each new
object of a law needs, walk by themselves, for speed.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import field, fields, is_dataclass
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from ev_msgs_py.arguments import checked
from ev_msgs_py.contract.wheels import WHEEL_NAMES

_WHEELS = len(WHEEL_NAMES)


@checked
def entry(start: float | bool = 0.0, *, unit: str, about: str = "") -> Any:
    """One number; a condition is 0.0 or 1.0.

    >>> from dataclasses import dataclass
    >>> from ev_core.law import entry
    >>> @dataclass(slots=True)
    ... class State:
    ...     integral: float = entry(0.0, unit="rad", about="of the error of the yaw rate")
    >>> State().integral
    0.0
    """
    return field(default=start, metadata={"unit": unit, "about": about})


@checked
def per_wheel(start: float | bool = 0.0, *, unit: str, about: str = "") -> Any:
    """One number for each wheel, in the order of Wheels."""
    return series(_WHEELS, start, unit=unit, about=about)


@checked
def series(count: int, start: float | bool = 0.0, *, unit: str, about: str = "") -> Any:
    """A fixed number of numbers, such as a window of samples."""
    return field(default_factory=lambda: [start] * count, metadata={"unit": unit, "about": about})


class Place(NamedTuple):
    """One number of a `row`."""

    name: str
    unit: str
    about: str = ""


def wheel_places(name: str, unit: str, about: str = "") -> tuple[Place, ...]:
    """A place for each wheel, in the order of Wheels."""
    return tuple(Place(f"{name}.{wheel}", unit, about) for wheel in WHEEL_NAMES)


@checked
def row(places: Sequence[Place]) -> Any:
    """Numbers with names and units that are worked on as one array, as by an integrator."""
    return field(default_factory=lambda: [0.0] * len(places), metadata={"places": tuple(places)})


def part(of: type) -> Any:
    """A record within the record."""
    return field(default_factory=of)


def each_wheel(of: type) -> Any:
    """A record for each wheel, in the order of Wheels."""
    return field(default_factory=lambda: [of() for _ in range(_WHEELS)])


def record_type(values: Any) -> np.dtype:
    """The layout of a record, or of a tree of mappings, in compiled code.

    All numbers are float64, in order of declaration.
    """
    return _type_of(shape_of_record(values))


@cache
def _type_of(shape: tuple[Any, ...]) -> np.dtype:
    return np.dtype([(name, *_element_type(of)) for name, of in zip(*shape, strict=True)])


def _element_type(shape: Any) -> tuple[Any, ...]:
    if shape is None:
        return (np.float64,)
    if not isinstance(shape[0], int):
        return (_type_of(shape),)
    count, inner = shape
    return np.float64 if inner is None else _type_of(inner), (count,)


def shape_of_record(values: Any) -> tuple[Any, ...]:
    """Key of a record's layout.

    Its names, and for each of them None for a number, a shape, or a count and a shape.
    """
    items = _items(values)
    return tuple([name for name, _ in items]), tuple([_shape(value) for _, value in items])


def _shape(value: Any) -> Any:
    # Nearly all are floats, so they are asked for first.
    if type(value) is float or _is_number(value):
        return None
    if not isinstance(value, (list, tuple, np.ndarray, Sequence)):
        return shape_of_record(value)
    # Elements of a list are alike, so the first one stands for all.
    if not len(value) or _is_number(value[0]):
        return len(value), None
    return len(value), shape_of_record(value[0])


def memory_type(of: type) -> np.dtype:
    """The layout of a declared record for functions that make one as working memory.

    `working_memory(layout)[0].name` means the same in Python and compiled; TypeError for a name
    that would not.
    """
    return _with_attributes(of.__name__, record_type(of()))


def _with_attributes(name: str, kind: np.dtype) -> np.dtype:
    """The same layout of records that have their entries as attributes, as compiled ones do."""
    if kind.subdtype is not None:
        inner, shape = kind.subdtype
        return np.dtype((_with_attributes(name, inner), shape))
    if kind.names is None:
        return kind
    entries = []
    for each in kind.names:
        if hasattr(np.record, each):
            raise TypeError(
                f"{name}.{each}: the name is one of numpy's own, expected another one: {each}_"
            )
        entries.append((each, _with_attributes(f"{name}.{each}", kind[each])))
    return np.dtype((np.record, entries))


def working_memory(layout: np.dtype) -> np.ndarray:
    """One record of zeros, shape (1,), until the function that asks for it returns.

    Compiled it lies on the stack.
    """
    return np.zeros(1, layout)


def _items(values: Any) -> Iterable[tuple[str, Any]]:
    kind: type = type(values)
    declared = _declared(kind)
    if declared is not None:
        return [(name, getattr(values, name)) for name in declared]
    return values.items() if isinstance(values, (dict, Mapping)) else vars(values).items()


@cache
def _declared(kind: type) -> tuple[str, ...] | None:
    """The names of the entries of a declared record, None for other types."""
    return tuple(f.name for f in fields(kind)) if is_dataclass(kind) else None


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float, np.number))


class Held(NamedTuple):
    """One number of a record, and the record or list that holds it."""

    name: str  # dotted, with the wheel or place of a list's element
    holder: Any
    key: Any  # the name of the entry in a record, the index in a list

    @property
    def value(self) -> Any:
        """The number as it is held now."""
        if isinstance(self.holder, list):
            return self.holder[self.key]
        return getattr(self.holder, self.key)

    def set(self, number: float) -> None:
        """Put a number into its place."""
        if isinstance(self.holder, list):
            self.holder[self.key] = number
        else:
            setattr(self.holder, self.key, number)


def places(record: Any, prefix: str = "") -> Iterator[Held]:
    """All numbers of a declared record, in the order of `numbers`."""
    for declared in fields(record):
        value = getattr(record, declared.name)
        name = prefix + declared.name
        if is_dataclass(value):
            yield from places(value, f"{name}.")
        elif isinstance(value, list):
            inner = _element_names(name, value, declared.metadata.get("places"))
            for i, (each, element) in enumerate(zip(inner, value, strict=False)):
                if is_dataclass(element):
                    yield from places(element, f"{each}.")
                else:
                    yield Held(each, value, i)
        else:
            yield Held(name, record, declared.name)


def _element_names(name: str, elements: Sequence[Any], row: Sequence[Place] | None) -> list[str]:
    """Names of the elements of a list.

    Those of wheels end with the wheel, others with their place in the list. The places of a `row`
    have names of their own, on the level of the record's entries.
    """
    if row is not None:
        before = name[: name.rfind(".") + 1]
        return [before + place.name for place in row]
    ends = WHEEL_NAMES if len(elements) == _WHEELS else range(len(elements))
    return [f"{name}.{end}" for end in ends]


def entries_without_number(record: Any) -> Iterator[tuple[str, Any]]:
    """Dotted name and value of everything in a record that is no number and replaces one."""
    for held in places(record):
        if not _is_number(held.value):
            yield held.name, held.value


def numbers(values: Any) -> list[float]:
    """All numbers of a record or a tree, in order of declaration."""
    found: list[float] = []
    for _, value in _items(values):
        _append(found, value)
    return found


def _append(found: list[float], value: Any) -> None:
    if type(value) is float:  # nearly all are
        found.append(value)
    elif _is_number(value):
        found.append(float(value))
    elif isinstance(value, (list, tuple, np.ndarray)):
        if len(value) and _is_number(value[0]):
            found += map(float, value)
        else:
            for element in value:
                _append(found, element)
    else:
        found += numbers(value)


def fill(record: Any, row: Sequence[float]) -> None:
    """Set all numbers of a record from a row as `numbers` gives it.

    ValueError if its length is another one.
    """
    there = list(places(record))
    if len(there) != len(row):
        more = "more" if len(there) > len(row) else "fewer"
        raise ValueError(f"{type(record).__name__} has {more} than {len(row)} numbers")
    for held, number in zip(there, row, strict=True):
        held.set(float(number))


def names(record: Any) -> list[str]:
    """One dotted name for each number of a declared record."""
    return [held.name for held in places(record)]
