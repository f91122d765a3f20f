"""The parameters of a sensor."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from ev_msgs_py.parameters.declaration import parameter


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
