"""Values for declared parameters, also with a unit ("80 km/h"), checked or refused.

Numbers with a unit as people write them, "80 km/h", made into the unit in which a parameter is
declared. A list and no algebra of units: the accepted units can be read here, and a refusal lists
them.
"""

import dataclasses
import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import fields, is_dataclass
from functools import cache
from typing import Any, TypeVar

import numpy as np

from ev_core.parameters.declaration import Choice, Entry, entries, is_declared
from ev_msgs_py.refusal import ParameterError, quoted, unknown_name

# By declared unit, what may be written instead: a number is multiplied by the first and divided by
# the second.
# Two exact numbers, so that "80 km/h" is what 80/3.6 is in Python, to the last bit.
_TURN = 2.0 * math.pi
_KILO = (1e3, 1.0)
ACCEPTED: dict[str, dict[str, tuple[float, float]]] = {
    "1": {"%": (1.0, 100.0)},
    "m": {"mm": (1.0, 1e3), "cm": (1.0, 100.0), "km": _KILO},
    "m^2": {"cm^2": (1.0, 1e4)},
    "m/s": {"km/h": (1.0, 3.6), "mph": (0.44704, 1.0)},
    "s": {"ms": (1.0, 1e3), "min": (60.0, 1.0), "h": (3600.0, 1.0)},
    "kg": {"t": _KILO, "g": (1.0, 1e3)},
    "rad": {"deg": (math.pi, 180.0)},
    "rad/s": {"deg/s": (math.pi, 180.0), "rpm": (_TURN, 60.0), "1/min": (_TURN, 60.0)},
    "N": {"kN": _KILO},
    "N m": {"Nm": (1.0, 1.0), "kN m": _KILO, "kNm": _KILO},
    "N/m": {"kN/m": _KILO, "N/mm": _KILO},
    "N/rad": {"kN/rad": _KILO, "N/deg": (180.0, math.pi), "kN/deg": (180e3, math.pi)},
    "W": {"kW": _KILO, "MW": (1e6, 1.0)},
    "J": {"kJ": _KILO, "Wh": (3600.0, 1.0), "kWh": (3.6e6, 1.0)},
    "A h": {"Ah": (1.0, 1.0)},
    "V": {"kV": _KILO},
    "ohm": {"mohm": (1.0, 1e3)},
    "Hz": {"kHz": _KILO},
}
_FORM = re.compile(r"\s*(?P<number>[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?)\s*(?P<unit>\S.*?)\s*")
P = TypeVar("P")
_ELEMENTS = {float: "numbers", int: "whole numbers", bool: "true or false", str: "texts"}


def units_for(unit: str) -> tuple[str, ...]:
    """The units in which a parameter of a declared unit may be written; none for texts and such."""
    own = () if unit in ("", "1") else (unit,)
    return (*own, *ACCEPTED.get(unit, ()))


def number_of(text: str, unit: str) -> float | None:
    """The number in the declared unit; None if the text is no number with an accepted unit."""
    found = _FORM.fullmatch(text)
    if found is None or found["unit"] not in units_for(unit):
        return None
    multiplier, divisor = ACCEPTED.get(unit, {}).get(found["unit"], (1.0, 1.0))
    return float(found["number"]) * multiplier / divisor


def check(entry: Entry, value: Any) -> Any:
    """The value as the dataclass keeps it.

    A number is a float where a float is meant, an array is a tuple. Raises ParameterError for a
    wrong type, a value out of range, NaN or infinity.
    """
    value = plain(value)
    if entry.is_array:
        if isinstance(value, (str, bytes, Mapping)) or not isinstance(value, Iterable):
            raise _refused(entry, value, f"an array of {_ELEMENTS[entry.type]}")
        return tuple(_check_element(entry, plain(element)) for element in value)
    return _check_element(entry, value)


def refuse_undeclared(label: str, parameters: Any) -> None:
    """Refuse a class unless its parameters are declared and their defaults accepted.

    The line of the TypeError begins with `label`.
    """
    if not isinstance(parameters, type) or not is_dataclass(parameters):
        given = type(parameters).__name__
        if isinstance(parameters, type):
            given = f"class {parameters.__name__}"
        raise TypeError(
            f"{label}: parameters are {given}, "
            "expected a class marked @dataclass(frozen=True, slots=True)"
        )
    for f in fields(parameters):
        is_group = f.default_factory is not dataclasses.MISSING and is_dataclass(
            f.default_factory()
        )
        if not is_group and not is_declared(f):
            raise TypeError(
                f"{label}: {f.name} is no declared parameter, write {f.name}: ... = parameter(...)"
            )
    for entry in entries(parameters):
        if entry.type not in _ELEMENTS:
            # An annotation may be anything, also an object without a name.
            kind = entry.type.__name__ if isinstance(entry.type, type) else entry.type
            raise TypeError(
                f"{label}: {entry.name} is declared as {kind}, "
                "expected float, int, bool, str or tuple[one, ...]"
            )
        try:
            check(entry, entry.default)
        except ParameterError as error:
            raise TypeError(f"{label}: the default of {error}") from None


def plain(value: Any) -> Any:
    """A number or an array of numpy as Python's own; everything else as it is."""
    return value.tolist() if isinstance(value, np.generic | np.ndarray) else value


def _check_element(entry: Entry, value: Any) -> Any:
    spec = entry.spec
    if entry.type is float:
        if isinstance(value, str):
            value = _with_unit(entry, value)
        # To Python true is a number, to a user it is none.
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
    elif "\0" in value:  # no file has it in its name, and ROS cuts a text off there
        raise _refused(entry, value, "a text without the character NUL")
    too_low = spec.low is not None and value < spec.low
    too_high = spec.high is not None and value > spec.high
    unknown = bool(spec.choices) and value not in spec.choices
    if too_low or too_high or unknown:
        raise _refused(entry, value, spec.allowed)
    return value


def _with_unit(entry: Entry, text: str) -> float:
    """Value of a text such as 80 km/h in the unit of the parameter."""
    number = number_of(text, entry.spec.unit)
    if number is None:
        units = units_for(entry.spec.unit)
        with_unit = f", or a text of a number and one of {', '.join(units)}" if units else ""
        raise _refused(entry, text, f"a number, {entry.spec.allowed}{with_unit}")
    return number


def _refused(entry: Entry, value: Any, allowed: str) -> ParameterError:
    return ParameterError(
        f"parameter {entry.name}: {quoted(value)} is refused, expected {allowed}", entry.name
    )


def build(of: type[P], values: Mapping[str, Any], prefix: str = "") -> P:
    """An instance of a parameter dataclass from dotted names and values.

    What is not named keeps its default. Raises ParameterError for unknown names and bad values;
    nothing is built then.
    """
    return replaced(of(), values, prefix)


def replaced(instance: P, values: Mapping[str, Any], prefix: str = "") -> P:
    """A parameter dataclass with other values by dotted name; what is not named stays as it is.

    Raises ParameterError for unknown names and bad values; nothing is built then.
    """
    kind: type = type(instance)
    known = entries_by_name(kind, prefix)
    for name in values:
        if name not in known:
            raise unknown_name("parameter", name, known)
    checked = {name: check(known[name], value) for name, value in values.items()}
    made: P = _replaced(instance, checked, prefix)
    return made


@cache
def entries_by_name(of: type, prefix: str = "") -> Mapping[str, Entry]:
    """All parameters of a parameter dataclass by their full dotted names."""
    return {entry.name: entry for entry in entries(of, prefix)}


def _replaced(instance: Any, checked: Mapping[str, Any], prefix: str) -> Any:
    changed: dict[str, Any] = {}
    of_groups: dict[str, dict[str, Any]] = {}
    for name, value in checked.items():
        own, dot, _ = name[len(prefix) :].partition(".")
        if dot:
            of_groups.setdefault(own, {})[name] = value
        else:
            before = getattr(instance, own)
            changed[own] = type(before).of(value) if isinstance(before, Choice) else value
    for group, values in of_groups.items():
        changed[group] = _replaced(getattr(instance, group), values, f"{prefix}{group}.")
    try:
        return dataclasses.replace(instance, **changed) if changed else instance
    except ParameterError as error:  # relations between parameters, checked in __post_init__
        raise ParameterError(f"{prefix}{error}" if prefix else str(error)) from None
