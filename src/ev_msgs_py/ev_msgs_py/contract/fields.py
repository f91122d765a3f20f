"""What is known of each field of a signal, and the one order of its numbers that frames, messages and hashes share."""

import math
import struct
import typing
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

from ev_msgs_py.contract.wheels import WHEEL_NAMES, Wheels


@dataclass(frozen=True, slots=True)
class Field:
    """Unit, meaning, place in the message, the sensor that measures it, and its precision in the message.

    `place` is a path in the message, such as twist.linear.x; in a JointState it is JOINT.ARRAY, such as drive.effort,
    where {wheel} stands for the name of each wheel. `sensor` names the sensor, which fields with one name share, and
    `largest` is the largest error that its parameters accept, in the unit. `lateral` is what points or turns
    to the left, `never_negative` what has no direction.
    """

    unit: str
    about: str
    place: str
    sensor: str = ""
    largest: float = 0.0
    single_precision: bool = False
    lateral: bool = False
    never_negative: bool = False


def leftward(unit: str, about: str, place: str, sensor: str = "", largest: float = 0.0) -> Field:
    """A Field of what changes its sign where left and right are exchanged."""
    return Field(unit, about, place, sensor, largest, lateral=True)


def magnitude(unit: str, about: str, place: str, sensor: str = "", largest: float = 0.0, **how: Any) -> Field:
    """A Field of what has no direction."""
    return Field(unit, about, place, sensor, largest, never_negative=True, **how)


NEGLIGIBLE = 1e-9  # what rounding leaves of a - b where both are the same number of up to 1e6, and far below any torque


def field_of(hint: Any) -> Field:
    """The Field in an annotation; TypeError if there is none."""
    for each in getattr(hint, "__metadata__", ()):
        if isinstance(each, Field):
            return each
    raise TypeError(f"{hint} says nothing about unit, meaning and place of the field")


_FLOAT = struct.calcsize("d")
_OF_WHEELS = struct.Struct(f"{len(WHEEL_NAMES)}d")
_of_wheels = _OF_WHEELS.unpack_from
_new = tuple.__new__  # of a named tuple, without the detour by the names of its fields


class SignalError(ValueError):
    """A signal holds a number that no message may carry; the message names signal, field and value."""


class Shape:
    """The numbers of one signal type, a named tuple, in order of declaration, wheel by wheel.

    A signal is either per wheel in all its fields or in none; TypeError otherwise.
    """

    def __init__(self, signal: type) -> None:
        hints = typing.get_type_hints(signal, include_extras=True)
        self.signal = signal
        self.fields: dict[str, Field] = {name: field_of(hint) for name, hint in hints.items()}
        per_wheel = {hint.__origin__ is Wheels for hint in hints.values()}
        if len(per_wheel) > 1:
            raise TypeError(f"{signal.__name__} mixes numbers and values per wheel")
        self.per_wheel = per_wheel == {True}
        ends = [f".{wheel}" for wheel in WHEEL_NAMES] if self.per_wheel else [""]
        self.channels = tuple(f"{name}{end}" for name in self.fields for end in ends)
        self.units = tuple(field.unit for field in self.fields.values() for _ in ends)
        self.size = len(self.channels)
        self.has_single = any(field.single_precision for field in self.fields.values())
        self.single = tuple(field.single_precision for field in self.fields.values() for _ in ends)
        self.lateral = tuple(field.lateral for field in self.fields.values() for _ in ends)
        never_negative = [field for field in self.fields.values() for _ in ends]
        self.never_negative = tuple(i for i, field in enumerate(never_negative) if field.never_negative)
        # Those of them that no sensor shows, whose noise may be negative: commands.
        self.unsigned_commands = tuple(i for i in self.never_negative if not never_negative[i].sensor)

    def flat(self, signal: Any) -> tuple[float, ...]:
        """The numbers of a signal, in the order of `channels`."""
        return sum(signal, ()) if self.per_wheel else signal

    def signal_of(self, values: Sequence[float]) -> Any:
        """The signal with these numbers; the inverse of `flat`."""
        if len(values) != self.size:
            raise TypeError(f"{self.signal.__name__} has {self.size} numbers, not {len(values)}")
        if self.per_wheel:
            return _new(self.signal, [_new(Wheels, values[i : i + 4]) for i in range(0, len(values), 4)])
        return _new(self.signal, values)

    def carried(self, values: Sequence[float]) -> tuple[float, ...]:
        """The numbers as a message carries them: rounded where it has single precision; infinite beyond its range."""
        if not self.has_single:
            return tuple(values)
        return tuple(rounded(value) if single else value for value, single in zip(values, self.single, strict=True))

    def refuse_not_finite(self, values: Sequence[float]) -> None:
        """SignalError that names the first number that is not finite, or that single precision does not hold."""
        for channel, value, single in zip(self.channels, values, self.single, strict=True):
            if not math.isfinite(value):
                raise SignalError(f"{self.signal.__name__}.{channel} is {value}, only finite numbers are allowed")
            if single and not math.isfinite(rounded(value)):
                raise SignalError(
                    f"{self.signal.__name__}.{channel} is {value}, expected what single precision holds, up to 3.4e38"
                )

    def without_sign(self, values: Sequence[float], places: Sequence[int]) -> Sequence[float]:
        """The numbers; those at these places are never negative, SignalError if one is by more than rounding."""
        if all(values[place] >= 0.0 for place in places):
            return values
        if any(values[place] < -NEGLIGIBLE for place in places):
            raise self.negative(values, places)
        found = [*values]
        for place in places:
            found[place] = 0.0 if values[place] < 0.0 else values[place]
        return found

    def negative(self, values: Sequence[float], places: Sequence[int]) -> SignalError:
        """The error that names the first number of those at these places that is negative."""
        place = next(place for place in places if values[place] < -NEGLIGIBLE)
        return SignalError(f"{self.signal.__name__}.{self.channels[place]} is {values[place]}, expected 0 or more")

    def reader(self, place: int) -> Callable[[Any], Any]:
        """A function that gives the signal whose numbers stand in bytes of float64, from a place on."""
        signal, begin = self.signal, place * _FLOAT
        if self.per_wheel:
            begins = [begin + i * _OF_WHEELS.size for i in range(len(self.fields))]
            return lambda raw: _new(signal, [_new(Wheels, _of_wheels(raw, each)) for each in begins])
        unpack = struct.Struct(f"{self.size}d").unpack_from
        return lambda raw: _new(signal, unpack(raw, begin))


_SINGLE = struct.Struct("f")


def rounded(value: float) -> float:
    """The number in single precision, infinite beyond its range."""
    try:
        number: float = _SINGLE.unpack(_SINGLE.pack(value))[0]
    except OverflowError:
        return math.copysign(math.inf, value)
    return number


@cache
def shape_of(signal: type) -> Shape:
    """The shape of a signal type."""
    return Shape(signal)
