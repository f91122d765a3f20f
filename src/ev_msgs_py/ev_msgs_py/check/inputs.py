"""Random but plausible signals to step a method with, the same for the same seed."""

from __future__ import annotations

import random
from collections.abc import Sequence
from typing import Any

from ev_msgs_py.contract.field import Field
from ev_msgs_py.contract.shape import shape_of
from ev_msgs_py.contract.signals import Instant

# Largest magnitude by unit; a field that is never negative takes the magnitude.
_LARGEST = {"N m": 800.0, "rad": 0.6, "rad/s": 60.0, "m/s": 18.0, "m/s^2": 6.0, "N": 6000.0, "m": 50.0, "V": 400.0}
_NEVER_NEGATIVE = ("brake", "brake_torque", "load", "friction_coefficient", "voltage", "state_of_charge")
_REPEATED = 0.2  # probability that a number stays what it was
_ZERO = 0.2  # probability that a number is zero


class RandomInputs:
    """Signals of some types for one step after the other, `period` seconds apart."""

    def __init__(self, reads: Sequence[type], seed: int, period: float) -> None:
        self._reads = tuple(reads)
        self._random = random.Random(seed)
        self._period = period
        self._steps = 0
        self._last: dict[type, Any] = {}

    def next(self) -> tuple[Any, ...]:
        """The signals of the next step, in the order of the types."""
        now = Instant(self._steps * self._period)
        self._steps += 1
        return tuple(now if kind is Instant else self._signal(kind) for kind in self._reads)

    def _signal(self, kind: type) -> Any:
        shape = shape_of(kind)
        last = self._last.get(kind, (0.0,) * shape.size)
        values = []
        for channel, before in zip(shape.channels, last, strict=True):
            field = channel.partition(".")[0]
            values.append(self._number(shape.fields[field], before, field in _NEVER_NEGATIVE))
        self._last[kind] = tuple(values)
        return shape.signal_of(tuple(values))

    def _number(self, field: Field, before: float, never_negative: bool) -> float:
        chance = self._random.random()
        if chance < _REPEATED:
            return before
        if chance < _REPEATED + _ZERO:
            return 0.0
        value = self._random.uniform(-1.0, 1.0) * _LARGEST.get(field.unit, 1.0)
        return abs(value) if never_negative else value


_EXTREME = (0.0, 5e-324, 1e-300, 1e-30, 1e6, 1e20, 3e38, 1e150, 1e300, 1.7976931348623157e308)
_LARGEST_SINGLE = 3e38  # that single precision holds
_ABSURD = 0.3  # probability that a number is absurd


class ExtremeInputs(RandomInputs):
    """The same, with numbers in between that no car has: tiny ones, and up to the largest that a message carries."""

    def _number(self, field: Field, before: float, never_negative: bool) -> float:
        plausible = super()._number(field, before, never_negative)
        if self._random.random() >= _ABSURD:
            return plausible
        value = self._random.choice(_EXTREME)
        if field.single_precision:
            value = min(value, _LARGEST_SINGLE)
        return value if never_negative else self._random.choice((-1.0, 1.0)) * value
