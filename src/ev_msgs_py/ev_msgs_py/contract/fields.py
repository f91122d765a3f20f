"""Declaration of the fields of signals, and the one order of their numbers."""

import math
import struct
import typing
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

from ev_msgs_py.contract.wheels import WHEEL_NAMES, Wheels

# What rounding leaves of a - b where both are the same number of up to 1e6; far below any torque.
NEGLIGIBLE = 1e-9
_FLOAT = struct.calcsize("d")
_OF_WHEELS = struct.Struct(f"{len(WHEEL_NAMES)}d")
_SINGLE = struct.Struct("f")


@dataclass(frozen=True, slots=True)
class Field:
    """Unit, meaning, place in the message, sensor and precision of a field.

    `place` is a path in the message, such as twist.linear.x; in a JointState it is JOINT.ARRAY,
    such as drive.effort, where {wheel} stands for the name of each wheel. `sensor` names the
    sensor, which fields with one name share, and `largest` is the largest error that its parameters
    accept, in the unit. `lateral` is what points or turns to the left, `never_negative` what has no
    direction.
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


def magnitude(
    unit: str, about: str, place: str, sensor: str = "", largest: float = 0.0, **how: Any
) -> Field:
    """A Field of what has no direction."""
    return Field(unit, about, place, sensor, largest, never_negative=True, **how)


def field_of(hint: Any) -> Field:
    """The Field in an annotation; TypeError if there is none."""
    for each in getattr(hint, "__metadata__", ()):
        if isinstance(each, Field):
            return each
    raise TypeError(f"{hint} has nothing about unit, meaning and place of the field")


_of_wheels = _OF_WHEELS.unpack_from
_new = tuple.__new__  # of a named tuple, without the detour by the names of its fields


class SignalError(ValueError):
    """Number in a signal that no message may carry; the message names signal, field and value."""


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
        channels: list[str] = []
        of_numbers: list[Field] = []  # the field of each number
        for name, field in self.fields.items():
            channels += [f"{name}{end}" for end in ends]
            of_numbers += [field] * len(ends)
        self.channels = tuple(channels)
        self.size = len(channels)
        self.units = tuple(field.unit for field in of_numbers)
        self.single = tuple(field.single_precision for field in of_numbers)
        self.has_single = any(self.single)
        self.lateral = tuple(field.lateral for field in of_numbers)
        unsigned = [i for i, field in enumerate(of_numbers) if field.never_negative]
        self.never_negative = tuple(unsigned)
        # Commands are those of them that no sensor shows; its noise might be negative.
        self.unsigned_commands = tuple(i for i in unsigned if not of_numbers[i].sensor)

    def flat(self, signal: Any) -> tuple[float, ...]:
        """The numbers of a signal, in the order of `channels`."""
        return sum(signal, ()) if self.per_wheel else signal

    def signal_of(self, values: Sequence[float]) -> Any:
        """The signal with these numbers; the inverse of `flat`."""
        if len(values) != self.size:
            raise TypeError(f"{self.signal.__name__} has {self.size} numbers, not {len(values)}")
        if self.per_wheel:
            return _new(
                self.signal, [_new(Wheels, values[i : i + 4]) for i in range(0, len(values), 4)]
            )
        return _new(self.signal, values)

    def carried(self, values: Sequence[float]) -> tuple[float, ...]:
        """Numbers as a message carries them; infinite beyond the range of single precision."""
        if not self.has_single:
            return tuple(values)
        return tuple(
            rounded(value) if single else value
            for value, single in zip(values, self.single, strict=True)
        )

    def refuse_not_finite(self, values: Sequence[float]) -> None:
        """Raise SignalError for the first number that is not finite, or beyond its precision."""
        for channel, value, single in zip(self.channels, values, self.single, strict=True):
            if not math.isfinite(value):
                raise SignalError(
                    f"{self.signal.__name__}.{channel} is {value}, expected a finite number"
                )
            if single and not math.isfinite(rounded(value)):
                raise SignalError(
                    f"{self.signal.__name__}.{channel} is {value}, expected what single precision "
                    f"holds, up to 3.4e38"
                )

    def without_sign(self, values: Sequence[float], places: Sequence[int]) -> Sequence[float]:
        """Numbers with 0 for what rounding leaves below it at these places; else SignalError."""
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
        return SignalError(
            f"{self.signal.__name__}.{self.channels[place]} is {values[place]}, expected 0 or more"
        )

    def reader(self, place: int) -> Callable[[Any], Any]:
        """Function that makes the signal of bytes of float64, from a place on."""
        signal, begin = self.signal, place * _FLOAT
        if self.per_wheel:
            begins = [begin + i * _OF_WHEELS.size for i in range(len(self.fields))]
            return lambda raw: _new(
                signal, [_new(Wheels, _of_wheels(raw, each)) for each in begins]
            )
        unpack = struct.Struct(f"{self.size}d").unpack_from
        return lambda raw: _new(signal, unpack(raw, begin))


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
