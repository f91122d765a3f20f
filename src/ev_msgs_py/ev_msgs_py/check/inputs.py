"""Random but plausible signals to step a method with, the same for the same seed."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from typing import Any

from ev_msgs_py.check.launch import Launch
from ev_msgs_py.contract.field import Field
from ev_msgs_py.contract.shape import shape_of
from ev_msgs_py.contract.signals import Instant

# Largest magnitude by unit; a field that is never negative takes the magnitude.
_LARGEST = {"N m": 800.0, "rad": 0.6, "rad/s": 60.0, "m/s": 18.0, "m/s^2": 6.0, "N": 6000.0, "m": 50.0, "V": 400.0}
_BRAKES = ("brake", "brake_torque")
_REPEATED = 0.2  # probability that a number stays what it was
_ZERO = 0.2  # probability that a number is zero
_FREE = 0.5  # probability that the brake pedal is free for a while
_LONGEST = 40  # steps with numbers at random, behind which a launch may begin


class RandomInputs:
    """Signals of some types for one step after the other, `period` seconds apart.

    For a while all numbers are at random, with the brake pedal pressed or free. Then comes a launch, as long as what
    limits, estimates and counts needs in order to come into play.
    """

    launches = True

    def __init__(self, reads: Sequence[type], seed: int, period: float) -> None:
        self._reads = tuple(reads)
        self._random = random.Random(seed)
        self._period = period
        self._steps = 0
        self._left = 0
        self._launch: Launch | None = None
        self._last: dict[type, Any] = {}

    def next(self) -> tuple[Any, ...]:
        """The signals of the next step, in the order of the types."""
        if self._left == 0:
            self._begin()
        self._left -= 1
        now = Instant(self._steps * self._period)
        self._steps += 1
        moving: Mapping[type, Any] = self._launch.next() if self._launch else {}
        return tuple(now if kind is Instant else moving.get(kind) or self._signal(kind) for kind in self._reads)

    def _begin(self) -> None:
        launches = self.launches and self._launch is None
        self._launch = Launch(self._random, self._period) if launches and self._steps else None
        self._left = self._launch.steps if self._launch else self._random.randint(1, _LONGEST)
        self._is_free = self._random.random() < _FREE

    def _signal(self, kind: type) -> Any:
        shape = shape_of(kind)
        last = self._last.get(kind, (0.0,) * shape.size)
        values = []
        for channel, before in zip(shape.channels, last, strict=True):
            name = channel.partition(".")[0]
            is_released = self._is_free and name in _BRAKES
            values.append(0.0 if is_released else self._number(shape.fields[name], before))
        self._last[kind] = tuple(values)
        return shape.signal_of(tuple(values))

    def _number(self, field: Field, before: float) -> float:
        chance = self._random.random()
        if chance < _REPEATED:
            return before
        if chance < _REPEATED + _ZERO:
            return 0.0
        value = self._random.uniform(-1.0, 1.0) * _LARGEST.get(field.unit, 1.0)
        return abs(value) if field.never_negative else value


_EXTREME = (0.0, 5e-324, 1e-300, 1e-30, 1e6, 1e20, 3e38, 1e150, 1e300, 1.7976931348623157e308)
_LARGEST_SINGLE = 3e38  # that single precision holds
_ABSURD = 0.3  # probability that a number is absurd


class ExtremeInputs(RandomInputs):
    """The same without launches, with numbers that no car has: tiny ones, and up to the largest of a message."""

    launches = False

    def _number(self, field: Field, before: float) -> float:
        plausible = super()._number(field, before)
        if self._random.random() >= _ABSURD:
            return plausible
        value = self._random.choice(_EXTREME)
        if field.single_precision:
            value = min(value, _LARGEST_SINGLE)
        return value if field.never_negative else self._random.choice((-1.0, 1.0)) * value
