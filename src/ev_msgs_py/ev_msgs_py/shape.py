"""A signal as a flat row of numbers and back: the one order that messages, channels and hashes share."""

from __future__ import annotations

import math
import typing
from dataclasses import fields
from functools import cache
from itertools import chain
from operator import attrgetter
from typing import Any

from ev_msgs_py.wheels import WHEEL_NAMES, Wheels


class SignalError(ValueError):
    """A signal holds a number that no message may carry; the message names signal, field and value."""


class Shape:
    """The numbers of one signal type in order of declaration, wheel by wheel.

    A signal is either per wheel in all its fields or in none; TypeError otherwise.
    """

    def __init__(self, signal: type) -> None:
        hints = typing.get_type_hints(signal)
        self.signal = signal
        self.fields = tuple(f.name for f in fields(signal))
        per_wheel = {hints[name] is Wheels for name in self.fields}
        if len(per_wheel) > 1:
            raise TypeError(f"{signal.__name__} mixes numbers and values per wheel")
        self.per_wheel = per_wheel == {True}
        if self.per_wheel:
            self.channels = tuple(f"{name}.{wheel}" for name in self.fields for wheel in WHEEL_NAMES)
        else:
            self.channels = self.fields
        # A second name makes attrgetter return a tuple even where there is one field only.
        self._get = attrgetter(*self.fields, "__class__") if self.fields else lambda _: (None,)

    def flat(self, signal: Any) -> tuple[float, ...]:
        """The numbers of a signal, in the order of `channels`; SignalError if one is not finite."""
        values = self._get(signal)[:-1]
        if self.per_wheel:
            values = tuple(chain.from_iterable(values))
        if not math.isfinite(sum(values)):
            self._refuse(values)
        return values

    def _refuse(self, values: tuple[float, ...]) -> None:
        for channel, value in zip(self.channels, values, strict=True):
            if not math.isfinite(value):
                raise SignalError(f"{self.signal.__name__}.{channel} is {value}, only finite numbers are allowed")

    def signal_of(self, values: tuple[float, ...]) -> Any:
        """The signal with these numbers; the inverse of `flat`."""
        if not self.per_wheel:
            return self.signal(*values)
        return self.signal(*(Wheels._make(values[i : i + 4]) for i in range(0, len(values), 4)))


@cache
def shape_of(signal: type) -> Shape:
    """The shape of a signal type."""
    return Shape(signal)
