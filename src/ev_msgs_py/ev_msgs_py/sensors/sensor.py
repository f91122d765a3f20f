"""The parameters of a sensor."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from ev_msgs_py.parameters.declaration import parameter

DISTRIBUTIONS = ("gaussian", "uniform")
GAUSSIAN, UNIFORM = range(len(DISTRIBUTIONS))
_NO_RANGE = 1e30


@cache
def sensor_parameters(unit: str, largest: float) -> type:
    """The parameter dataclass of a sensor for numbers in `unit` and errors up to `largest`; by default it is ideal."""

    @dataclass(frozen=True, slots=True)
    class SensorParameters:
        """Errors of one sensor, in the order in which they come about."""

        gain: float = parameter(1.0, unit="1", low=0.5, high=2.0, about="what is shown over what is true")
        bias: float = parameter(0.0, unit=unit, low=-largest, high=largest, about="constant error")
        noise: float = parameter(
            0.0, unit=unit, low=0.0, high=largest, about="size of the random error, new in every period: `distribution`"
        )
        distribution: str = parameter(
            "gaussian",
            choices=DISTRIBUTIONS,
            about="of the random error; gaussian: its standard deviation is `noise`; uniform: `noise` is its bound",
        )
        lowest: float = parameter(
            -_NO_RANGE, unit=unit, low=-_NO_RANGE, high=_NO_RANGE, about="smallest value that it can show"
        )
        highest: float = parameter(
            _NO_RANGE, unit=unit, low=-_NO_RANGE, high=_NO_RANGE, about="largest value that it can show"
        )
        quantisation: float = parameter(
            0.0, unit=unit, low=0.0, high=largest, about="distance between the values that it can show; 0: shows all"
        )
        delay: int = parameter(0, unit="1", low=0, high=1000, about="age of the value, in whole control periods")
        dropout: float = parameter(
            0.0, unit="1", low=0.0, high=1.0, about="probability that a period brings no value and the last one stays"
        )

    return SensorParameters
