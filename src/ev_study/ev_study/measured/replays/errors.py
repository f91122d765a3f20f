"""Errors of a signal against the record: in all, by window and by range of lateral acceleration.

How it works: all errors are simulated minus measured, in windows, (windows, samples). Where nothing
was measured the record has NaN, and no number counts these samples. One window that spins decides
an RMS of all, so the median over windows stands beside it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from ev_stack.measures.metric import Metric
from ev_stack.report.tables import text_table

# [s]; a signal that comes later than its replay by as much shifts what is found by more than noise
# does
LATE = 0.03
# share of the variance that a replay has to have, below which a lag is a matter of chance
CLEAR = 0.5
RANGES = (0.0, 2.0, 4.0, 6.0, 8.0, np.inf)  # of the magnitude of the lateral acceleration [m/s^2]


@dataclass(frozen=True, slots=True)
class Errors:
    """Simulated minus measured, in the unit of the signal.

    `explained` is the share of the variance of the measured signal that the replay has, 1 -
    var(error)/var(measured). `lag` [s] is by how much the simulated signal comes later, where the
    correlation of both is largest; NaN where it is not known. `samples` is their number.
    """

    rms: float
    largest: float
    bias: float
    explained: float
    lag: float
    samples: int

    def as_json(self) -> dict[str, Any]:
        """Content for summary.json, in which no number is infinite."""
        return {name: value if np.isfinite(value) else None for name, value in asdict(self).items()}


def errors_of(
    simulated: np.ndarray, measured: np.ndarray, period: float = 0.0, most: float = 0.3
) -> Errors:
    """Errors of series (windows, n) or (n,).

    A lag of at most `most` [s] is looked for if there is a `period` [s].
    """
    error = simulated - measured
    there = np.isfinite(error)
    # NaN is what was not measured, or a car without finite numbers; `spins` finds the latter.
    error, of = error[there], measured[there]
    if not len(error):
        return Errors(np.nan, np.nan, np.nan, np.nan, np.nan, 0)
    variance = float(np.var(of))
    return Errors(
        float(np.sqrt(np.mean(error**2))),
        float(np.max(np.abs(error))),
        float(np.mean(error)),
        # By the variance, so a constant offset does not lower it: that is `bias`.
        1.0 - float(np.var(error)) / variance if variance > 0.0 else np.nan,
        _lag(simulated, measured, period, most) if period > 0.0 else np.nan,
        len(error),
    )


def _lag(simulated: np.ndarray, measured: np.ndarray, period: float, most: float) -> float:
    """Lag by a parabola through the largest correlation of all finite windows."""
    whole = (np.isfinite(simulated) & np.isfinite(measured)).all(axis=1)
    # The simulated signal loses `reach` samples at both ends, which the shifted one needs.
    reach = round(most / period)
    if not whole.any() or simulated.shape[1] <= 4 * reach:
        return float("nan")
    one = simulated[whole][:, reach:-reach]
    shifts = np.arange(-reach, reach + 1)
    size = measured.shape[1]
    # All windows together: a single one may be a straight, in which nothing correlates.
    correlation = np.array(
        [
            np.corrcoef(one.ravel(), measured[whole][:, reach - k : size - reach - k].ravel())[0, 1]
            for k in shifts
        ]
    )
    if not np.isfinite(correlation).all():
        return float("nan")
    best = int(np.argmax(correlation))
    if not 0 < best < len(shifts) - 1:
        return float("nan")  # nowhere within reach
    before, at, after = correlation[best - 1 : best + 2]
    # The vertex of the parabola through the three points; no vertex without a bend downwards.
    bend = before - 2.0 * at + after
    return float((shifts[best] + (0.5 * (before - after) / bend if bend < 0.0 else 0.0)) * period)


def by_window(simulated: np.ndarray, measured: np.ndarray) -> np.ndarray:
    """The RMS error of each window, (windows,); NaN where no number is finite."""
    squared = (simulated - measured) ** 2
    there = np.isfinite(squared)
    return np.sqrt(
        np.where(there, squared, 0.0).sum(axis=1)
        / np.where(there.any(axis=1), there.sum(axis=1), np.nan)
    )


def by_range(
    simulated: np.ndarray, measured: np.ndarray, acceleration: np.ndarray
) -> Mapping[str, Errors]:
    """The errors of the samples in each of `RANGES` of a lateral acceleration [m/s^2] of the same shape."""
    which = np.digitize(np.abs(acceleration), RANGES[1:-1])
    return {
        name: errors_of(simulated[chosen], measured[chosen])
        for n, name in enumerate(range_names())
        if (chosen := which == n).any()
    }


def range_names() -> list[str]:
    """The ranges in words."""
    return [
        f"{low:g} to {high:g}" if np.isfinite(high) else f"above {low:g}"
        for low, high in pairwise(RANGES)
    ]


def spins(
    sideslip: np.ndarray, measured: np.ndarray, limit: float = np.radians(20.0)
) -> np.ndarray:
    """Mark windows that leave the record: not finite, or with a sideslip angle far from it.

    A window without a measured sideslip angle (NaN) is not judged by it.
    """
    # Compared with the measured angle, not with zero: a real car may slide as well.
    away = np.where(np.isfinite(measured), np.abs(sideslip - measured), 0.0)
    return ~np.isfinite(sideslip).all(axis=1) | (
        np.nan_to_num(away, nan=np.inf).max(axis=1) > limit
    )


@dataclass(frozen=True)
class Judged:
    """A signal of a `unit` beside the measured one: all errors, those by range, and the RMS error of each window."""

    unit: str
    errors: Errors
    ranges: Mapping[str, Errors]
    of_windows: np.ndarray

    @property
    def median_window(self) -> float:
        """The RMS error of the median window; NaN where no number is finite."""
        return (
            float(np.nanmedian(self.of_windows))
            if np.isfinite(self.of_windows).any()
            else float("nan")
        )

    def is_late(self, name: str) -> str:
        """The line on a measured signal that comes well before or behind the simulated one.

        Empty if it does not.
        """
        if not (abs(self.errors.lag) > LATE and self.errors.explained > CLEAR):
            return ""
        # The lag is that of the simulated signal, so a negative one is a measured signal that is
        # late.
        when = "late" if self.errors.lag < 0.0 else "early"
        return (
            f"{name} is measured {abs(self.errors.lag):.3f} s {when}: clock or filter of a sensor,"
            " or another car"
        )

    def metrics(self, name: str) -> dict[str, Metric]:
        """Metrics for summary.json and the page; their names begin with `name`."""
        numbers = {"rms": self.errors.rms, "largest": self.errors.largest, "bias": self.errors.bias}
        found = {
            f"{name}_{what}": (
                Metric(value, self.unit)
                if np.isfinite(value)
                else Metric(None, self.unit, reason="not finite")
            )
            for what, value in (numbers | {"median_window": self.median_window}).items()
        }
        if np.isfinite(self.errors.explained):
            found[f"{name}_explained"] = Metric(self.errors.explained, "1")
        return found

    def as_json(self) -> dict[str, Any]:
        """Content for summary.json."""
        windows = [value if np.isfinite(value) else None for value in self.of_windows.tolist()]
        ranges = {label: each.as_json() for label, each in self.ranges.items()}
        return {"errors": self.errors.as_json(), "by_range": ranges, "by_window": windows}


def judged(
    unit: str, found: np.ndarray, measured: np.ndarray, acceleration: np.ndarray, period: float
) -> Judged:
    """Signals in windows (windows, n), with the lateral acceleration [m/s^2] there and the period [s]."""
    errors, ranges = errors_of(found, measured, period), by_range(found, measured, acceleration)
    return Judged(unit, errors, ranges, by_window(found, measured))


def error_table(of: Mapping[str, Judged]) -> str:
    """Table for the terminal: errors by signal, of the median window and by range."""
    rows = []
    for name, each in of.items():
        rows.append(
            [name, "all", *_cells(each.errors, each.unit), _number(each.median_window, each.unit)]
        )
        rows += [
            ["", f"{label} m/s2", *_cells(errors, each.unit), ""]
            for label, errors in each.ranges.items()
        ]
    columns = (
        "signal",
        "v r",
        "rms",
        "largest",
        "bias",
        "explained",
        "lag [s]",
        "samples",
        "median window",
    )
    return text_table(columns, rows, left=("signal", "v r"))


def _cells(errors: Errors, unit: str) -> list[str]:
    lag = f"{errors.lag:.3f}" if np.isfinite(errors.lag) else "-"
    numbers = [_number(value, unit) for value in (errors.rms, errors.largest, errors.bias)]
    return [*numbers, f"{errors.explained:.4f}", lag, str(errors.samples)]


def _number(value: float, unit: str) -> str:
    """A number with its unit; an angle in degrees beside."""
    return f"{value:.4g} {unit}" + (f" ({np.degrees(value):.3g} deg)" if unit == "rad" else "")
