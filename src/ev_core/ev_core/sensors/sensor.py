"""The parameters of a sensor."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from ev_core.parameters.declaration import setting
from ev_msgs_py.refusal import ParameterError

DISTRIBUTIONS = ("gaussian", "uniform")
GAUSSIAN, UNIFORM = range(len(DISTRIBUTIONS))
_NO_RANGE = 1e30


@cache
def sensor_parameters(unit: str, largest: float) -> type:
    """The parameter dataclass of a sensor for numbers in `unit` and errors up to `largest`; by default it is ideal."""

    @dataclass(frozen=True, slots=True)
    class SensorParameters:
        """Errors of one sensor, in the order in which they come about."""

        gain: float = setting(1.0, unit="1", low=0.5, high=2.0, about="what is shown over what is true")
        bias: float = setting(0.0, unit=unit, low=-largest, high=largest, about="constant error")
        noise: float = setting(
            0.0, unit=unit, low=0.0, high=largest, about="size of the random error, new in every period: `distribution`"
        )
        bias_of_range: float = setting(
            0.0, unit="1", low=-1.0, high=1.0, about="constant error over the range from lowest to highest, on top"
        )
        noise_of_reading: float = setting(
            0.0, unit="1", low=0.0, high=1.0, about="random error over the true value, on top of `noise`"
        )
        noise_of_range: float = setting(
            0.0, unit="1", low=0.0, high=1.0, about="random error over lowest to highest, on top of `noise`"
        )
        distribution: str = setting(
            "gaussian",
            choices=DISTRIBUTIONS,
            about="of the random error; gaussian: its standard deviation is `noise`; uniform: `noise` is its bound",
        )
        lowest: float = setting(
            -_NO_RANGE, unit=unit, low=-_NO_RANGE, high=_NO_RANGE, about="smallest value that it can show"
        )
        highest: float = setting(
            _NO_RANGE, unit=unit, low=-_NO_RANGE, high=_NO_RANGE, about="largest value that it can show"
        )
        quantisation: float = setting(
            0.0, unit=unit, low=0.0, high=largest, about="distance between the values that it can show; 0: shows all"
        )
        delay: int = setting(0, unit="1", low=0, high=1000, about="age of the value, in whole control periods")
        dropout: float = setting(
            0.0, unit="1", low=0.0, high=1.0, about="probability that a period brings no value and the last one stays"
        )

        def __post_init__(self) -> None:
            if self.lowest > self.highest:
                raise ParameterError(f"lowest is {self.lowest:g}, allowed is at most highest, {self.highest:g}")
            for name in ("bias_of_range", "noise_of_range"):
                if getattr(self, name) != 0.0 and max(-self.lowest, self.highest) >= _NO_RANGE:
                    raise ParameterError(f"{name} needs a range: lowest and highest")

        @property
        def offset(self) -> float:
            """Constant error in all."""
            return self.bias + (self.bias_of_range * (self.highest - self.lowest) if self.bias_of_range else 0.0)

        @property
        def least_noise(self) -> float:
            """Size of the random error of a true value of 0."""
            return self.noise + (self.noise_of_range * (self.highest - self.lowest) if self.noise_of_range else 0.0)

    return SensorParameters
