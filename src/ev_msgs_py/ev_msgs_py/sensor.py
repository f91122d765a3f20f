"""One sensor: what noise, bias, quantisation, delay and drop-out make of a few true numbers."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from ev_msgs_py.parameters import parameter


@cache
def sensor_parameters(unit: str, largest: float) -> type:
    """The parameter dataclass of a sensor for numbers in `unit` and errors up to `largest`; by default it is ideal."""

    @dataclass(frozen=True, slots=True)
    class SensorParameters:
        """Errors of one sensor, in the order in which they come about."""

        bias: float = parameter(0.0, unit=unit, low=-largest, high=largest, about="constant error")
        noise: float = parameter(
            0.0, unit=unit, low=0.0, high=largest, about="standard deviation of the Gaussian error, new in every period"
        )
        quantisation: float = parameter(
            0.0, unit=unit, low=0.0, high=largest, about="distance between the values that it can show; 0: shows all"
        )
        delay: int = parameter(0, unit="1", low=0, high=1000, about="age of the value, in whole control periods")
        dropout: float = parameter(
            0.0, unit="1", low=0.0, high=1.0, about="probability that a period brings no value and the last one stays"
        )

    return SensorParameters


class Sensor:
    """Measures some numbers once per control period.

    Noise and bias come first, then quantisation; the result is on its way for `delay` periods and may then be lost, all
    numbers of the sensor at once. Until the first value has arrived, and where the first one is lost, the first holds.

    The random numbers are those of numpy's PCG64, seeded by `seed` and `name`. Every period takes a normal one for
    each number and a uniform one, whatever the parameters are: other parameters of this or another sensor never
    change what is drawn.
    """

    def __init__(self, parameters: Any, seed: int, name: str) -> None:
        self._p = parameters
        self._random = np.random.Generator(np.random.PCG64((seed, int.from_bytes(name.encode()))))
        self._under_way: deque[tuple[float, ...]] = deque(maxlen=parameters.delay + 1)
        self._shown: tuple[float, ...] | None = None

    def measure(self, true: tuple[float, ...]) -> tuple[float, ...]:
        """What the sensor shows in this period, in which these are the true numbers."""
        normal = self._random.standard_normal(len(true)).tolist()
        is_lost = self._random.random() < self._p.dropout
        self._under_way.append(tuple(map(self._sample, true, normal)))
        if self._shown is None or not is_lost:
            self._shown = self._under_way[0]
        return self._shown

    def _sample(self, true: float, normal: float) -> float:
        p = self._p
        value = true + p.bias + p.noise * normal
        if p.quantisation == 0.0 or not math.isfinite(value):  # whoever publishes it says which number is not finite
            return value
        return value - math.remainder(value, p.quantisation)
