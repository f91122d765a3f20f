"""The sensors behind one object, in plain Python: what they are told and what they keep, as two rows of numbers."""

from __future__ import annotations

import zlib
from collections.abc import Collection, Iterator
from typing import Any

from ev_msgs_py.contract.shape import shape_of
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.parameters.declaration import defaults
from ev_msgs_py.sensors.measuring import DELAY, HEAD, NAME, NUMBERS, WIDTH, Numbers, measure
from ev_msgs_py.sensors.quantities import QUANTITIES, Quantity
from ev_msgs_py.sensors.sensor import DISTRIBUTIONS


class SensorRow:
    """Those of some sensors that are not ideal; `parameters` are as `quantities.sensors_for` declares them.

    With fewer wheels `driven` a test bench has fewer channels. `constants` and `state` are rows of numbers as
    `measuring` has them, the state all that lasts.
    """

    def __init__(self, parameters: Any, seed: int, driven: Collection[str] = WHEEL_NAMES) -> None:
        self.constants = [0.0] * HEAD
        self._size = 1
        for quantity, errors in imperfect(parameters):
            for part in quantity.parts(driven):
                self.constants += self._told(quantity, errors, seed, part)
        total = len(self.constants)
        self.constants[:HEAD] = float(total), float(self._size), float((total - HEAD) // WIDTH)
        self.start()

    def _told(self, quantity: Quantity, errors: Any, seed: int, part: range) -> list[float]:
        places = quantity.places[part.start : part.start + 1] if quantity.kind == NUMBERS else quantity.places
        memory, self._size = self._size, self._size + len(part) * (1 + errors.delay)
        told = [quantity.kind, *places, *[0] * (3 - len(places)), len(part), shape_of(quantity.signal).has_single]
        told += [memory, errors.offset, errors.least_noise, errors.quantisation, errors.delay, errors.dropout]
        told += [seed, zlib.crc32(quantity.name.encode()), errors.gain, errors.lowest, errors.highest]
        told += [DISTRIBUTIONS.index(errors.distribution), errors.noise_of_reading, part.start // 2]
        return [float(value) for value in told]

    def start(self) -> None:
        """Begin anew, before the first period."""
        self.state = [0.0] * self._size

    def go_on_from(self, other: Any) -> None:
        """Go on where others were, if they are the same sensors with the same delays; else begin anew."""
        if self._lines() == other._lines():
            self.state = list(other.state)

    def _lines(self) -> list[tuple[float, float]]:
        """Name and delay of each sensor."""
        return [(self.constants[n + NAME], self.constants[n + DELAY]) for n in range(HEAD, len(self.constants), WIDTH)]

    def step(self, frame: Numbers) -> None:
        """Put what the sensors show into a frame of true numbers; once per period, the first time at the start."""
        measure(frame, self.state, self.constants)


def imperfect(parameters: Any) -> Iterator[tuple[Quantity, Any]]:
    """The quantities whose sensors have errors, and these."""
    for quantity in QUANTITIES:
        errors = getattr(parameters, quantity.name, None)
        if errors is not None and errors != _ideal(errors):
            yield quantity, errors


def _ideal(errors: Any) -> Any:
    kind: type = type(errors)
    return defaults(kind)
