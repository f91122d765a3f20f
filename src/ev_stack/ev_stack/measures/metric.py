"""A number that a run yields, beside the published one, and reading samples for it."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ev_stack.recording.recording import Recording

Band = tuple[float, float]  # an end that is not finite is open
REPRODUCED = "reproduced"
NOT_REPRODUCED = "not reproduced"
NOT_MEASURED = "not measured"
NOT_JUDGED = "not judged"
FROM_INPUTS = "follows from the inputs"
LOWER, HIGHER = "lower", "higher"  # which values of a metric are better; empty where neither is
TYRES = "tire_forces."  # begins the channels that only a plant with tyres has


class NotMeasured(Exception):
    """A metric cannot be computed; the message says why in one line."""


class NotJudged(NotMeasured):
    """A verdict that cannot be given, since a part of it was not judged.

    The message gives the reason.
    """


@dataclass(frozen=True, slots=True)
class Reference:
    """A published number, its source, and the band in which a run reproduces it.

    Both ends belong to the band.

    `source` states whether the number itself is printed or follows from printed equations and
    parameters. `assumption` names what had to be added to the source; empty if nothing. `inputs`
    says why a run cannot miss the number by physics, because it is among what the run is given;
    empty if it can.
    """

    value: float
    band: Band
    source: str
    assumption: str = ""
    inputs: str = ""


@dataclass(frozen=True, slots=True)
class Metric:
    """A number with its unit; `value` is None if it could not be computed, `reason` then says why.

    `unjudged` says why the reference does not bind it, such as another law than that of the source,
    or why there is no value to a verdict of its own. Of several seeds `value` is the mean,
    `per_seed` holds the single values in the order of the seeds. `formula` says in one line what is
    computed, `better` which values are better: LOWER, HIGHER or "" for neither.
    """

    value: float | None
    unit: str
    reference: Reference | None = None
    reason: str = ""
    per_seed: tuple[float, ...] = ()
    unjudged: str = ""
    formula: str = ""
    better: str = ""

    @property
    def standard_deviation(self) -> float | None:
        """Spread over the seeds (of a sample, n - 1); None for less than two seeds."""
        return statistics.stdev(self.per_seed) if len(self.per_seed) > 1 else None

    @property
    def in_words(self) -> str:
        """Yes or no for a condition; empty for any other number."""
        if self.value is None:
            return ""
        return condition(self.value, self.formula)

    @property
    def judgement(self) -> str:
        """Worth of the number: (not) measured, (not) judged, (not) reproduced, or only its inputs."""
        if self.value is None:
            # A verdict without a value has no reason of its own, only why it is not judged.
            return NOT_MEASURED if self.reason else NOT_JUDGED
        if self.reference is None:
            return "measured"
        if self.unjudged:
            return NOT_JUDGED
        low, high = self.reference.band
        if not low <= self.value <= high:
            return NOT_REPRODUCED
        return FROM_INPUTS if self.reference.inputs else REPRODUCED

    @property
    def note(self) -> str:
        """Reason or assumption that belongs to the judgement.

        It gives why nothing was measured or judged, or what was assumed, whether the number is
        reproduced by it or not.
        """
        if self.judgement == NOT_JUDGED:
            return self.unjudged
        if self.reference and self.value is not None:
            return self.reference.inputs or self.reference.assumption
        return self.reason

    @property
    def verdict(self) -> str:
        """Judgement and note in one line."""
        if not self.note:
            return self.judgement
        link = " with assumption " if self.judgement == REPRODUCED else ": "
        return self.judgement + link + self.note

    def as_json(self) -> dict[str, object]:
        """The entry of summary.json."""
        reference = self.reference
        return {
            "value": self.value,
            "unit": self.unit,
            **{name: text for name in ("formula", "better") if (text := getattr(self, name))},
            **(
                {"std": self.standard_deviation, "per_seed": list(self.per_seed)}
                if self.per_seed
                else {}
            ),
            "reference": reference.value if reference else None,
            "band": (
                # JSON has no infinity: an open end is null.
                [end if math.isfinite(end) else None for end in reference.band]
                if reference
                else None
            ),
            "verdict": self.verdict,
            "source": reference.source if reference else None,
            "assumption": (reference.assumption or None) if reference else None,
        }


def condition(value: float, formula: str) -> str:
    """Yes or no for a number with the formula "1: what holds; else 0"; empty for any other."""
    if not formula.startswith("1: "):
        return ""
    return {1.0: "yes", 0.0: "no"}.get(value, "")


def metric(
    measure: Callable[[], float],
    unit: str,
    formula: str = "",
    better: str = "",
    reference: Reference | None = None,
) -> Metric:
    """Build the metric that `measure` returns.

    A metric has no value if `measure` raises NotMeasured or returns a number that is not finite.
    """

    def without_value(reason: str = "", unjudged: str = "") -> Metric:
        return Metric(
            None, unit, reference, reason, unjudged=unjudged, formula=formula, better=better
        )

    try:
        value = float(measure())
    # Before NotMeasured, of which it is a kind.
    except NotJudged as why:
        return without_value(unjudged=str(why))
    except NotMeasured as why:
        return without_value(str(why))
    # summary.json takes no NaN, and a band would judge it as missed.
    if not math.isfinite(value):
        return without_value(f"the result is {value}")
    return Metric(value, unit, reference, formula=formula, better=better)


def mean_over_seeds(
    values: Sequence[float], unit: str, reference: Reference | None = None
) -> Metric:
    """The mean of the values of all seeds, which are finite and at least one."""
    return Metric(statistics.fmean(values), unit, reference, per_seed=tuple(values))


def within(value: float, *, relative: float = 0.0, absolute: float = 0.0) -> Band:
    """Band around a published value: a fraction of it plus a distance in its unit."""
    half = abs(value) * relative + absolute
    return value - half, value + half


Runs = Mapping[str, Recording]  # name of the run -> its signals
Parameters = Mapping[str, Mapping[str, Any]]  # node -> dotted parameter name -> value


def run_named(runs: Runs, name: str) -> Recording:
    """The run of a scenario; NotMeasured if it was not driven."""
    if name not in runs:
        raise NotMeasured(f"there is no run {name}")
    return runs[name]


def stretches(holds: np.ndarray) -> list[slice]:
    """Instants in a row at which a condition holds, (n,) bool, stretch by stretch."""
    edges = np.flatnonzero(np.diff(holds, prepend=False, append=False)).tolist()
    return [slice(*edge) for edge in zip(edges[::2], edges[1::2], strict=True)]


def channel(recording: Recording, name: str) -> np.ndarray:
    """Samples of a channel, (n,).

    Raises NotMeasured if the channel is missing, empty, not finite or not the true motion.
    """
    # A metric is of the true motion; what a sensor made of it would be another quantity.
    if name in recording.unknown:
        raise NotMeasured(
            f"{name} was recorded as its sensor shows it, and what is true is not known"
        )
    if name not in recording.channels:
        raise NotMeasured(
            "the plant has no tyres" if name.startswith(TYRES) else f"{name} was not recorded"
        )
    values = recording.channels[name]
    if not len(values):
        raise NotMeasured("the run has no samples")
    if not np.isfinite(values).all():
        raise NotMeasured(f"{name} is not finite at {recording.time[~np.isfinite(values)][0]:g} s")
    return values


def between(recording: Recording, start: float, end: float) -> np.ndarray:
    """Mark the samples with start <= time < end [s], (n,) bool.

    Raises NotMeasured if the run does not cover the window.

    The end is left out because at this instant the driver already answers to what comes next.
    """
    time = recording.time
    if not len(time):
        raise NotMeasured("the run has no samples")
    # Stamps are multiples of the period: rounding must not move a sample over the edge of the
    # window.
    rounding = 1e-9
    if time[0] > start + rounding or time[-1] < end - rounding:
        raise NotMeasured(
            f"the run lasts from {time[0]:g} s to {time[-1]:g} s, the window from {start:g} s to"
            f" {end:g} s"
        )
    inside: np.ndarray = (time >= start - rounding) & (time < end - rounding)
    if not inside.any():
        raise NotMeasured(f"there is no sample from {start:g} s to {end:g} s")
    return inside


def mean_between(recording: Recording, values: np.ndarray, start: float, end: float) -> float:
    """Mean over start <= time < end [s]; NotMeasured if the run does not cover the window."""
    return float(values[between(recording, start, end)].mean())


def last(recording: Recording, window: float) -> tuple[float, float]:
    """Start and end of the last `window` seconds of the run [s]."""
    if not len(recording.time):
        raise NotMeasured("the run has no samples")
    end = float(recording.time[-1])
    return end - window, end
