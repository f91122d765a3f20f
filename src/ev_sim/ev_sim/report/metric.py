"""A number that a run yields, beside the published one and the verdict on it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

Band = tuple[float, float]  # an end that is not finite is open


class NotMeasured(Exception):
    """A metric cannot be computed; the message says why in one line."""


@dataclass(frozen=True, slots=True)
class Reference:
    """A published number, the band (both ends included) in which a run reproduces it, and where it comes from.

    `source` says whether the number itself is printed or follows from printed equations and parameters.
    `assumption` names what had to be added to the source; empty if nothing.
    """

    value: float
    band: Band
    source: str
    assumption: str = ""


@dataclass(frozen=True, slots=True)
class Metric:
    """A number with its unit; `value` is None if it could not be computed, `reason` then says why."""

    value: float | None
    unit: str
    reference: Reference | None = None
    reason: str = ""

    @property
    def judgement(self) -> str:
        """What the number is worth: measured, not measured, reproduced or not reproduced."""
        if self.value is None:
            return "not measured"
        if self.reference is None:
            return "measured"
        low, high = self.reference.band
        return "reproduced" if low <= self.value <= high else "not reproduced"

    @property
    def note(self) -> str:
        """What belongs to the judgement: why nothing was measured, or what had to be assumed to reproduce it."""
        if self.judgement == "reproduced":
            return self.reference.assumption  # type: ignore[union-attr]
        return self.reason

    @property
    def verdict(self) -> str:
        """Judgement and note in one line."""
        if not self.note:
            return self.judgement
        link = " with assumption " if self.judgement == "reproduced" else ": "
        return self.judgement + link + self.note

    def as_json(self) -> dict[str, object]:
        """The entry of summary.json."""
        reference = self.reference
        return {
            "value": self.value,
            "unit": self.unit,
            "published": reference.value if reference else None,
            "band": [end if math.isfinite(end) else None for end in reference.band] if reference else None,
            "verdict": self.verdict,
            "source": reference.source if reference else None,
            "assumption": (reference.assumption or None) if reference else None,
        }


def metric(measure: Callable[[], float], unit: str, reference: Reference | None = None) -> Metric:
    """The metric that `measure` returns; what raises NotMeasured or is not finite becomes a metric without value."""
    try:
        value = float(measure())
    except NotMeasured as why:
        return Metric(None, unit, reference, str(why))
    if not math.isfinite(value):
        return Metric(None, unit, reference, f"the result is {value}")
    return Metric(value, unit, reference)


def within(value: float, *, relative: float = 0.0, absolute: float = 0.0) -> Band:
    """The band around a published value, by a fraction of it and by a distance in its unit (their sum)."""
    half = abs(value) * relative + absolute
    return value - half, value + half
