"""The sensors behind one object, in plain Python: what they are told and what they keep, as two rows of numbers."""

from __future__ import annotations

import zlib
from collections.abc import Collection, Iterator, Sequence
from typing import Any

from ev_core.parameters.declaration import defaults
from ev_core.sensors.measuring import COUNT, DELAY, FIRST, HEAD, MEMORY, NAME, NUMBERS, WIDTH, Numbers, measure
from ev_core.sensors.quantities import QUANTITIES, Quantity
from ev_core.sensors.sensor import DISTRIBUTIONS
from ev_msgs_py.contract.fields import shape_of
from ev_msgs_py.contract.wheels import WHEEL_NAMES


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
        memory, self._size = self._size, self._size + 1 + len(part) * (1 + errors.delay)
        told = [quantity.kind, *places, *[0] * (3 - len(places)), len(part), shape_of(quantity.signal).has_single]
        told += [memory, errors.offset, errors.least_noise, errors.quantisation, errors.delay, errors.dropout]
        told += [seed, zlib.crc32(quantity.name.encode()), errors.gain, errors.lowest, errors.highest]
        told += [DISTRIBUTIONS.index(errors.distribution), errors.noise_of_reading, part.start // 2]
        return [float(value) for value in told]

    def start(self) -> None:
        """Begin anew, before the first period."""
        self.state = [0.0] * self._size

    def go_on_from(self, other: Any) -> None:
        """Go on in the period where others were; a sensor that has another delay or was not there begins with it."""
        self.state[0] = other.state[0]
        keep_memories(self, other, HEAD, WIDTH, (NAME, FIRST, COUNT, DELAY), MEMORY)

    def step(self, frame: Numbers) -> None:
        """Put what the sensors show into a frame of true numbers; once per period, the first time at the start."""
        measure(frame, self.state, self.constants)


def keep_memories(row: Any, other: Any, head: int, width: int, key: Sequence[int], memory: int) -> None:
    """Give a row of sensors or of faults what those of another one remember that have the same numbers at `key`."""
    before = dict(_memories(other, head, width, key, memory))
    for name, place in _memories(row, head, width, key, memory):
        if name in before:
            row.state[place] = other.state[before[name]]


def _memories(
    row: Any, head: int, width: int, key: Sequence[int], memory: int
) -> Iterator[tuple[tuple[float, ...], slice]]:
    """By name where each one's numbers stand in the state, up to those of the next one."""
    c = row.constants
    begins = [int(c[n + memory]) for n in range(head, len(c), width)]
    for i, end in enumerate([*begins[1:], len(row.state)]):
        yield tuple(c[head + i * width + k] for k in key), slice(begins[i], end)


def imperfect(parameters: Any) -> Iterator[tuple[Quantity, Any]]:
    """The quantities whose sensors have errors, and these."""
    for quantity in QUANTITIES:
        errors = getattr(parameters, quantity.name, None)
        if errors is not None and errors != _ideal(errors):
            yield quantity, errors


def _ideal(errors: Any) -> Any:
    kind: type = type(errors)
    return defaults(kind)
