"""One number of a published thing: how it is measured, and what it is held against.

How it works: a row of published.csv becomes a `Check` when it is read. Then its measure, needs,
unit and tolerance are checked, so a mistake is found before anything is driven. When the runs are
there, the check measures them and gives a `Metric` with its reference. A comparison in words
(`than`) is judged as a ratio of magnitudes.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from ev_msgs_py.refusal import ParameterError, quoted
from ev_stack.measures.metric import Band, Metric, NotMeasured, Reference, metric, within
from ev_study.verdicts.measure import (
    EMPTY,
    Call,
    Expression,
    Measures,
    Template,
    compared,
    measured_by,
)
from ev_study.verdicts.need import Need

SHOWN = "shown"  # in place of a value: the number is shown and not judged


@dataclass(frozen=True, slots=True)
class Tolerance:
    """A band around a published value (a fraction or a distance), or one with given ends.

    `why` is the reason of its width: what the source leaves open, or what sampling costs; never a
    desired result.
    """

    why: str
    relative: float = 0.0
    absolute: float = 0.0
    ends: Band | None = None

    @classmethod
    def of(cls, text: str, why: str) -> Tolerance:
        """The tolerance that a text means, `0.5 %` of the value, `0.02` in its unit or `1 .. 2`, an end of it open.

        Raises ParameterError for any other text, and if the reason is missing.
        """
        if not why:
            raise ParameterError(
                f"the tolerance {quoted(text)} has no reason, expected one in the column why"
            )
        try:
            # An end that is left out is open.
            if ".." in text:
                low, _, high = text.partition("..")
                ends = float(low.strip() or -math.inf), float(high.strip() or math.inf)
                if not ends[0] <= ends[1]:
                    raise ValueError
                return cls(why, ends=ends)
            number = float(text.removesuffix("%"))
            if not 0.0 <= number < math.inf:
                raise ValueError
        except ValueError:
            raise ParameterError(
                f"the tolerance {quoted(text)} is refused, expected such as '1 %' (of the value),"
                " '0.5' (in its unit), '0 .. 2', '.. 2' or '0 ..'"
            ) from None
        return cls(why, relative=number / 100) if text.endswith("%") else cls(why, absolute=number)

    def band(self, value: float) -> Band:
        """The band in which a number counts as the published value."""
        # Given ends go before a width: they need no value.
        return self.ends or within(value, relative=self.relative, absolute=self.absolute)

    def text(self, unit: str) -> str:
        """Width and reason, for a table."""
        if self.ends:
            low, high = self.ends
            inside = (
                f"{low:.6g} .. {high:.6g}"
                if math.isfinite(high) and math.isfinite(low)
                else _open(low, high)
            )
            width = f"{inside} {unit}".removesuffix(" 1")
        elif self.relative or not self.absolute:
            width = f"{100 * self.relative:g} %"
        else:
            # A distance between percentages is in points, so that it is not taken for a fraction of
            # the number.
            width = f"{self.absolute:.3g} {'points' if unit == '%' else unit}".removesuffix(" 1")
        return f"{width}: {self.why}"


def _open(low: float, high: float) -> str:
    return f"at least {low:.6g}" if math.isfinite(low) else f"at most {high:.6g}"


@dataclass(frozen=True, slots=True)
class Check:
    """A number that is held against a published one within a tolerance.

    `name` distinguishes the numbers of one id and is empty for the first. `than`: the claim in
    words is that the magnitude of `measure` is larger or, if not `is_larger`, smaller than that of
    `than` by more than the tolerance, a fraction of the larger one. `tolerance` and its reason
    `why` are empty for what is shown beside and not judged; `value` is None for both.
    """

    name: str
    unit: str
    needs: tuple[Need, ...]
    measure: Call | Expression
    value: float | None = None
    tolerance: Template = EMPTY
    why: Template = EMPTY
    than: Call | Expression | None = None
    is_larger: bool = False

    @property
    def is_judged(self) -> bool:
        """True if it is held against a published number, and not only shown beside it."""
        return bool(self.tolerance.parts)

    def metric(
        self, reference: Callable[[float, Band, str], Reference], driven: Sequence[Any]
    ) -> Metric:
        """The number with its reference.

        Of a claim in words the ratio [1], with both numbers in its source.
        """
        if not self.is_judged:
            return metric(lambda: self.measure(driven), self.unit)
        # A claim in words is held against the ratio 1.
        band = self._tolerance(driven).band(1.0 if self.value is None else self.value)
        if self.value is not None:
            return metric(
                lambda: self.measure(driven), self.unit, reference=reference(self.value, band, "")
            )
        assert self.than is not None
        try:
            # Magnitudes: larger means further from zero, whatever the sign convention of the
            # quantity is.
            value, other = abs(self.measure(driven)), abs(self.than(driven))
        except NotMeasured as why:
            return Metric(None, "1", reference(1.0, band, ""), str(why))
        compared = f"; measured {value:.5g} against {other:.5g} {self.unit}".removesuffix(" 1")
        return metric(
            # No ratio to zero: `metric` gives what is not finite no value, so this is not measured.
            lambda: value / other if other else math.inf,
            "1",
            reference=reference(1.0, band, compared),
        )

    def allowed(self, driven: Sequence[Any]) -> str:
        """Width and reason of the tolerance, for a table."""
        if not self.is_judged:
            return "shown, not judged"
        return self._tolerance(driven).text("1" if self.than else self.unit)

    def band(self) -> Band:
        """The band of a tolerance that does not depend on what was driven."""
        return self._tolerance(()).band(1.0 if self.value is None else self.value)

    def _tolerance(self, driven: Sequence[Any]) -> Tolerance:
        found = Tolerance.of(self.tolerance.filled(driven), self.why.filled(driven))
        if not self.than:
            return found
        # The tolerance t is a share of the larger number: x (1 - t) > y, or x < y (1 - t).
        ends = (1 / (1 - found.relative), math.inf) if self.is_larger else (0.0, 1 - found.relative)
        return Tolerance(found.why, ends=ends)

    def text(self, value: float) -> str:
        """A value with its unit, a judged angle in degrees as well; a ratio as a change."""
        if self.than:
            return f"{100 * (value - 1):+.3g} %"
        degrees = (
            f" ({math.degrees(value):.2f} deg)" if self.unit == "rad" and self.is_judged else ""
        )
        return f"{value:.5g} {self.unit}{degrees}".removesuffix(" 1")

    def renamed(self, words: Mapping[str | float, str | float]) -> Check:
        """The same number with other words for its measures, such as the names of other runs."""
        return replace(
            self, measure=self.measure.renamed(words), than=self.than and self.than.renamed(words)
        )


def check_of(row: Mapping[str, str], measures: Measures, needs: tuple[Need, ...]) -> Check:
    """The check of a row of published.csv.

    Raises ParameterError that names what is refused and what is expected.
    """
    text, value = row["measure"], row["value"]
    _refuse_unit(row["unit"])
    tolerance, why = (Template.of(row[name], measures, needs) for name in ("tolerance", "why"))
    first, sign, than = compared(text)
    check = Check(row["name"], row["unit"], needs, measured_by(first, measures, needs))
    if value == SHOWN:
        if row["tolerance"] or row["why"]:
            raise ParameterError(
                f"the tolerance {quoted(row['tolerance'])} is refused, expected beside {SHOWN} is"
                " none"
            )
        return check
    check = replace(check, tolerance=tolerance, why=why)
    if not row["tolerance"]:
        raise ParameterError(
            f"the tolerance is missing, expected one with its reason, or {SHOWN!r} for the value"
        )
    # Other texts are known only when their runs are driven.
    if tolerance.is_plain and why.is_plain:
        found = Tolerance.of(row["tolerance"], row["why"])
        # Without a width any difference would do, and by 100 % nothing can be smaller.
        if sign and not 0.0 < found.relative < 1.0:
            raise ParameterError(
                f"the tolerance {quoted(row['tolerance'])} is refused, expected for a comparison is"
                " more than 0 % and less than 100 % of the larger number"
            )
    if sign:
        if value:
            raise ParameterError(
                f"the value {quoted(value)} is refused, expected for a comparison is none"
            )
        return replace(check, than=measured_by(than, measures, needs), is_larger=sign == ">")
    try:
        number = float(value)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise ParameterError(
            f"the value {quoted(value)} is refused, expected a finite number or {SHOWN!r}"
        )
    return replace(check, value=number)


_SYMBOLS = {
    "1",
    "%",
    "m",
    "s",
    "rad",
    "deg",
    "kg",
    "N",
    "W",
    "J",
    "V",
    "A",
    "Hz",
    "Pa",
    "K",
    "h",
    "min",
    "km",
    "rpm",
}
_SYMBOLS |= {"kN", "kW", "kWh", "kJ", "MJ", "degC", "g", "mm", "ms", "kPa", "Ohm"}


def _refuse_unit(unit: str) -> None:
    """ParameterError unless a unit is a product of known symbols and their powers, over at most one other."""
    # A power is part of a symbol: m/s^2 is m over s.
    parts = unit.split("/")
    words = [re.sub(r"\^\d$", "", word) for part in parts for word in part.split() or [""]]
    if len(parts) > 2 or not _SYMBOLS.issuperset(words):
        allowed = f"such as 'N m', 'm/s^2' or '1', of {', '.join(sorted(_SYMBOLS))}"
        raise ParameterError(f"the unit {quoted(unit)} is not known, expected {allowed}")
