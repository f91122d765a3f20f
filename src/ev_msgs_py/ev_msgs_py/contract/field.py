"""All that is known of one field of a signal, written once, at the field."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Field:
    """Unit, meaning, place in the message, precision there, and the sensor that measures it.

    `place` is a path in the message, such as twist.linear.x; in a JointState it is JOINT.ARRAY, such as drive.effort,
    where {wheel} stands for the name of each wheel. `sensor` names the sensor, which fields with one name share, and
    `largest` is the largest error that its parameters accept, in the unit. `lateral` is what points or turns
    to the left, `never_negative` what has no direction.
    """

    unit: str
    about: str
    place: str
    single_precision: bool = False
    sensor: str = ""
    largest: float = 0.0
    lateral: bool = False
    never_negative: bool = False


def leftward(unit: str, about: str, place: str, **more: Any) -> Field:
    """A Field of what changes its sign where left and right are exchanged."""
    return Field(unit, about, place, lateral=True, **more)


def magnitude(unit: str, about: str, place: str, **more: Any) -> Field:
    """A Field of what has no direction."""
    return Field(unit, about, place, never_negative=True, **more)


def field_of(hint: Any) -> Field:
    """The Field in an annotation; TypeError if there is none."""
    for said in getattr(hint, "__metadata__", ()):
        if isinstance(said, Field):
            return said
    raise TypeError(f"{hint} says nothing about unit, meaning and place of the field")
