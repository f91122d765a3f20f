"""Parameters of running nodes from typed text: a value, or YAML."""

from __future__ import annotations

from typing import Any

import yaml
from rclpy.parameter import Parameter

from ev_msgs_py.refusal import quoted
from ev_stack.scenarios.parameter_file import read_yaml

_LONGEST_TEXT = 100_000  # characters; YAML of more would hold the pages up
_WHOLE = range(-(2**63), 2**63)
_KINDS = {
    Parameter.Type.DOUBLE: float,
    Parameter.Type.INTEGER: int,
    Parameter.Type.BOOL: bool,
    Parameter.Type.STRING: str,
}  # all others are arrays: the kind of an empty one is not known


def parameter_of(name: str, kind: Parameter.Type, value: Any) -> Parameter:
    """The parameter of that kind.

    Raises ValueError in one line if the value, or YAML in a text, cannot be carried.
    """
    try:
        # A text for a text is taken as it is: YAML would make a number of "12" and a truth of
        # "off".
        given = _read(value) if isinstance(value, str) and kind != Parameter.Type.STRING else value
        if kind in _KINDS:
            return Parameter(name, kind, *_alike([given], _KINDS[kind]))
        if not isinstance(given, list):
            raise TypeError
        # One float makes all numbers floats, as ROS does not mix them.
        kinds = {type(element) for element in given}
        return Parameter(
            name, value=_alike(given, float if float in kinds else next(iter(kinds), str))
        )
    except (TypeError, ValueError, OverflowError, yaml.YAMLError):
        allowed = (
            kind.name.lower() if kind in _KINDS else "an array in brackets, [] for an empty one"
        )
        raise ValueError(f"{quoted(value)} is refused, expected {allowed}") from None


def _read(text: str) -> Any:
    if len(text) > _LONGEST_TEXT:
        raise ValueError
    return read_yaml(text)


def _alike(values: list[Any], kind: type) -> list[Any]:
    """The values, all of one kind, whole numbers where others are meant among them.

    Raises TypeError or ValueError if not.
    """
    made = [float(value) if kind is float and type(value) is int else value for value in values]
    for value in made:
        if type(value) is not kind or kind not in _KINDS.values():
            raise TypeError
        if kind is int and value not in _WHOLE:
            raise ValueError
        if kind is str and b"\0" in value.encode():  # ROS would cut it off there
            raise ValueError
    return made
