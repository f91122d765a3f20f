"""The range in which the source wants the slip of a driven wheel (dissertation, eq 1.5)."""

from __future__ import annotations

from dataclasses import dataclass

from ev_core.law import ParameterError, parameter


@dataclass(frozen=True, slots=True)
class SlipThresholdParameters:
    """The two ends of the range, printed as "0.15 > S > 0.19"."""

    low: float = parameter(
        0.15, unit="1", low=0.0, high=1.0, about="slip below which the torque may rise", source="dissertation, eq 1.5"
    )
    high: float = parameter(
        0.19, unit="1", low=0.0, high=1.0, about="slip above which it has to fall", source="dissertation, eq 1.5"
    )

    def __post_init__(self) -> None:
        if self.low > self.high:
            raise ParameterError(f"low is {self.low:g}, allowed is at most high, {self.high:g}")
