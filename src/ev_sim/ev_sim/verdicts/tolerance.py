"""How far a number may lie from the published one, and why so far."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ev_sim.report.metric import Band, within


@dataclass(frozen=True, slots=True)
class Tolerance:
    """A band around a published value (a fraction of it plus a distance in its unit), or a band with given ends.

    `why` is the reason of its width: what the source leaves open, or what sampling costs; never a wish.
    """

    why: str
    relative: float = 0.0
    absolute: float = 0.0
    ends: Band | None = None

    def band(self, value: float) -> Band:
        """The band in which a number counts as the published value."""
        return self.ends or within(value, relative=self.relative, absolute=self.absolute)

    def text(self, unit: str) -> str:
        """Width and reason, for a table."""
        if self.ends == (-math.inf, math.inf):
            return self.why
        if self.ends:
            low, high = self.ends
            inside = f"{low:.6g} .. {high:.6g}" if math.isfinite(high) and math.isfinite(low) else _open(low, high)
            width = f"{inside} {unit}".removesuffix(" 1")
        elif self.relative or not self.absolute:
            width = f"{100 * self.relative:g} %" + (f" + {self.absolute:g} {unit}" if self.absolute else "")
        else:
            # A distance between percentages is in points, so that it is not taken for a fraction of the number.
            width = f"{self.absolute:.3g} {'points' if unit == '%' else unit}".removesuffix(" 1")
        return f"{width}: {self.why}"


def _open(low: float, high: float) -> str:
    return f"at least {low:.6g}" if math.isfinite(low) else f"at most {high:.6g}"


def relative(fraction: float, why: str) -> Tolerance:
    """A band by a fraction of the published value."""
    return Tolerance(why, relative=fraction)


def absolute(distance: float, why: str) -> Tolerance:
    """A band by a distance in the unit of the published value."""
    return Tolerance(why, absolute=distance)


def between(low: float, high: float, why: str) -> Tolerance:
    """A band with given ends, which may be infinite."""
    return Tolerance(why, ends=(low, high))
