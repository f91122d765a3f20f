"""A signal as a flat row of numbers and back: the one order that messages, channels and hashes share."""

from __future__ import annotations

import math
import typing
from functools import cache
from itertools import chain
from typing import Any

from ev_msgs_py.wheels import WHEEL_NAMES, Wheels

_wheels = Wheels._make


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

    def flat(self, signal: Any) -> tuple[float, ...]:
        """The numbers of a signal, in the order of `channels`; SignalError if one is not finite."""
        values = tuple(chain.from_iterable(signal)) if self.per_wheel else signal
        if not math.isfinite(sum(values)):
            self._refuse(values)
        return values

    def _refuse(self, values: tuple[float, ...]) -> None:
        for channel, value in zip(self.channels, values, strict=True):
            if not math.isfinite(value):
                raise SignalError(f"{self.signal.__name__}.{channel} is {value}, only finite numbers are allowed")

    def signal_of(self, values: tuple[float, ...]) -> Any:
        """The signal with these numbers; the inverse of `flat`."""
        if self.per_wheel:
            values = [_wheels(values[i : i + 4]) for i in range(0, len(values), 4)]
        return self.signal._make(values)


@cache
def shape_of(signal: type) -> Shape:
    """The shape of a signal type."""
    return Shape(signal)
