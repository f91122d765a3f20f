"""A signal as a flat row of numbers and back: the one order that messages, channels and hashes share."""

from __future__ import annotations

import math
import struct
import typing
from collections.abc import Callable
from functools import cache
from typing import Any

from ev_msgs_py.wheels import WHEEL_NAMES, Wheels

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
        hints = typing.get_type_hints(signal)
        self.signal = signal
        self.fields = signal._fields
        per_wheel = {hints[name] is Wheels for name in self.fields}
        if len(per_wheel) > 1:
            raise TypeError(f"{signal.__name__} mixes numbers and values per wheel")
        self.per_wheel = per_wheel == {True}
        if self.per_wheel:
            self.channels = tuple(f"{name}.{wheel}" for name in self.fields for wheel in WHEEL_NAMES)
        else:
            self.channels = self.fields
        self.size = len(self.channels)
        self.packing = struct.Struct(f"{self.size}d")

    def flat(self, signal: Any) -> tuple[float, ...]:
        """The numbers of a signal, in the order of `channels`; SignalError if one is not finite."""
        values = sum(signal, ()) if self.per_wheel else signal
        if not math.isfinite(sum(values)):
            self._refuse(values)
        return values

    def writer(self, numbers: Any) -> Callable[[Any], None]:
        """A function that puts the numbers of a signal behind those of the last one, in a buffer of float64.

        It raises SignalError as `flat`.
        """
        flat, pack, size = self.flat, self.packing.pack_into, self.packing.size
        memory, place = memoryview(numbers).cast("B"), 0

        def write(signal: Any) -> None:
            nonlocal place
            pack(memory, place, *flat(signal))
            place += size

        return write

    def _refuse(self, values: tuple[float, ...]) -> None:
        for channel, value in zip(self.channels, values, strict=True):
            if not math.isfinite(value):
                raise SignalError(f"{self.signal.__name__}.{channel} is {value}, only finite numbers are allowed")

    def signal_of(self, values: tuple[float, ...]) -> Any:
        """The signal with these numbers; the inverse of `flat`."""
        if len(values) != self.size:
            raise TypeError(f"{self.signal.__name__} has {self.size} numbers, not {len(values)}")
        if self.per_wheel:
            values = [_new(Wheels, values[i : i + 4]) for i in range(0, len(values), 4)]
        return _new(self.signal, values)

    def reader(self, numbers: Any, place: int) -> Callable[[], Any]:
        """A function that gives the signal whose numbers a buffer of float64 holds just then, from a place on."""
        signal, begin = self.signal, place * _FLOAT
        if self.per_wheel:
            begins = [begin + i * _OF_WHEELS.size for i in range(len(self.fields))]
            return lambda: _new(signal, [_new(Wheels, _of_wheels(numbers, each)) for each in begins])
        unpack = self.packing.unpack_from
        return lambda: _new(signal, unpack(numbers, begin))


@cache
def shape_of(signal: type) -> Shape:
    """The shape of a signal type."""
    return Shape(signal)
