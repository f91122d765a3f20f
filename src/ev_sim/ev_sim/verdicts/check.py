"""One number of a published thing: how it is measured, and what it is held against."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from ev_sim.measures.metric import Band, Metric, NotMeasured, Reference, metric, within
from ev_sim.verdicts.sources import Published


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


Measure = Callable[..., float]  # takes what was driven, one argument for each of the needs; may raise NotMeasured
Tolerances = Tolerance | Callable[..., Tolerance]


@dataclass(frozen=True, slots=True)
class Basis:
    """On what the checks of an id are judged: what was published, what had to be assumed, what the run is given."""

    published: Published
    assumption: str = ""
    inputs: str = ""

    def reference(self, value: float, band: Band, compared: str = "") -> Reference:
        """A value with its band and where it comes from."""
        of = self.published
        source = f"{of.kind}{': ' if of.where else ''}{of.where}{compared}"
        return Reference(value, band, source, self.assumption, self.inputs)


@dataclass(frozen=True, slots=True)
class Number:
    """A number that is held against a published one within a tolerance.

    `name` tells the numbers of one id apart and is empty for the first. A tolerance that depends on what was driven
    (ideal or switched drives) is a function of it.
    """

    unit: str
    value: float
    tolerance: Tolerances
    measure: Measure
    name: str = ""

    def metric(self, of: Basis, driven: tuple[Any, ...]) -> Metric:
        """The number with its reference and judgement."""
        band = self.tolerance_for(driven).band(self.value)
        return metric(lambda: self.measure(*driven), self.unit, of.reference(self.value, band))

    @property
    def judged_unit(self) -> str:
        """Unit of what lies within the tolerance."""
        return self.unit

    def tolerance_for(self, driven: tuple[Any, ...]) -> Tolerance:
        """The tolerance for what was driven."""
        return self.tolerance(*driven) if callable(self.tolerance) else self.tolerance

    def text(self, value: float) -> str:
        """A value with its unit, an angle in degrees as well."""
        degrees = f" ({math.degrees(value):.2f} deg)" if self.unit == "rad" else ""
        return f"{value:.5g} {self.unit}{degrees}".removesuffix(" 1")


@dataclass(frozen=True, slots=True)
class Comparison:
    """A claim in words that one quantity is larger, or smaller, than another: the ratio of their magnitudes.

    The claim holds if they differ by more than `margin` of the larger one; `why` says what noise the margin keeps out.
    """

    unit: str
    larger: bool
    margin: float
    why: str
    measure: Measure
    against: Measure
    name: str = ""

    def metric(self, of: Basis, driven: tuple[Any, ...]) -> Metric:
        """The ratio [1], with both numbers in its source."""
        band = self.tolerance_for(driven).band(1.0)
        try:
            value, other = abs(self.measure(*driven)), abs(self.against(*driven))
        except NotMeasured as why:
            return Metric(None, "1", of.reference(1.0, band), str(why))
        compared = f"; measured {value:.5g} against {other:.5g} {self.unit}".removesuffix(" 1")
        return metric(lambda: value / other if other else math.inf, "1", of.reference(1.0, band, compared))

    @property
    def judged_unit(self) -> str:
        """Unit of what lies within the tolerance: a ratio."""
        return "1"

    def tolerance_for(self, driven: tuple[Any, ...]) -> Tolerance:
        """The band of the ratio that the margin leaves."""
        if self.larger:
            return between(1 / (1 - self.margin), math.inf, self.why)
        return between(0.0, 1 - self.margin, self.why)

    def text(self, value: float) -> str:
        """A ratio, as a change."""
        return f"{100 * (value - 1):+.3g} %" if math.isfinite(value) else "from nothing"


@dataclass(frozen=True, slots=True)
class Shown:
    """A number that stands beside the judged ones: another reading, or what our own runs have."""

    unit: str
    measure: Measure
    name: str

    @property
    def judged_unit(self) -> str:
        """Unit of the number."""
        return self.unit

    def metric(self, of: Basis, driven: tuple[Any, ...]) -> Metric:
        """The number without a reference."""
        return metric(lambda: self.measure(*driven), self.unit)

    def tolerance_for(self, driven: tuple[Any, ...]) -> Tolerance:
        """None that could fail."""
        return between(-math.inf, math.inf, "shown, not judged")

    def text(self, value: float) -> str:
        """A value with its unit."""
        return f"{value:.5g} {self.unit}".removesuffix(" 1")


Check = Number | Comparison | Shown


def larger(unit: str, measure: Measure, against: Measure, margin: float, why: str, name: str = "") -> Comparison:
    """The claim that the magnitude of `measure` exceeds that of `against`."""
    return Comparison(unit, True, margin, why, measure, against, name)


def smaller(unit: str, measure: Measure, against: Measure, margin: float, why: str, name: str = "") -> Comparison:
    """The claim that the magnitude of `measure` is below that of `against`."""
    return Comparison(unit, False, margin, why, measure, against, name)


def holds(measure: Callable[..., bool], why: str, name: str = "") -> Number:
    """A statement that is true or false of what was driven, as 1 or 0."""
    return Number("1", 1.0, between(1.0, 1.0, why), lambda *driven: float(measure(*driven)), name)
