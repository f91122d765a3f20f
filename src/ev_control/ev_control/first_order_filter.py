"""A first-order filter of measured numbers."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.compiling.compilable import compilable


@compilable
def filter_share(period: float, time_constant: float) -> float:
    """Share of the gap that a first-order filter closes in one period, by implicit Euler [1]."""
    return period / (period + time_constant)


@dataclass(slots=True)
class Filtered:
    """A number behind a first-order filter; the first one passes."""

    value: float | None = None

    def follow(self, value: float, share: float) -> float:
        """The filtered number, a share of the gap nearer to this one."""
        self.value = value if self.value is None else self.value + share * (value - self.value)
        return self.value
