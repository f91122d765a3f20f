"""Ratios that hold on a machine which does not keep its speed.

How it works: what is compared is measured in alternating rounds, A B A B, so that what slows the
machine slows both. A ratio is one of two values of one round. Its median over the rounds counts,
and the range of its middle half is its spread. With fewer than five rounds no ratio is reported,
nor where the spread is larger than the distance from the goal: the line says so instead.
"""

from __future__ import annotations

import platform
import statistics
import time
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

FEWEST = 5
Rounds = dict[str, list[float]]  # by name one value a round


class Ratio(NamedTuple):
    """A ratio over the rounds, beside its goal if it has one."""

    median: float
    low: float  # a quarter of the rounds is below
    high: float  # a quarter is above
    rounds: int
    goal: float | None = None

    @property
    def spread(self) -> float:
        """The range of the middle half of the rounds."""
        return self.high - self.low

    @property
    def value(self) -> float | None:
        """The median; None where it is not to be reported."""
        if self.rounds < FEWEST:
            return None
        if self.goal is not None and self.spread > abs(self.median - self.goal):
            return None
        return self.median

    def __str__(self) -> str:
        if self.rounds < FEWEST:
            return f"not reported: {self.rounds} of at least {FEWEST} rounds"
        goal = "" if self.goal is None else f", goal {self.goal:.2f}"
        if self.value is None:
            return f"not reported: spread {self.spread:.2f} larger than the distance from{goal[1:]}"
        return f"{self.median:.2f} (spread {self.spread:.2f}{goal})"


def alternating(measures: Mapping[str, Callable[[], float]], rounds: int) -> Rounds:
    """Measure all in turn, round after round; a first time, which compiles, does not count."""
    for measure in measures.values():
        measure()
    found: Rounds = {name: [] for name in measures}
    for _ in range(rounds):
        for name, measure in measures.items():
            found[name].append(measure())
    return found


def processor_time(call: Callable[[], object]) -> float:
    """Processor time of a call in this process [s]: that of others does not count."""
    start = time.process_time()
    call()
    return time.process_time() - start


def ratio_of(of: Sequence[float], to: Sequence[float], goal: float | None = None) -> Ratio:
    """Ratio of two rows of rounds."""
    ratios = [one / other for one, other in zip(of, to, strict=True)]
    low, median, high = ratios[0], ratios[0], ratios[0]
    if len(ratios) > 1:
        low, median, high = statistics.quantiles(ratios, n=4, method="inclusive")
    return Ratio(median, low, high, len(ratios), goal)


def as_json(ratio: Ratio) -> dict[str, float | None]:
    """Entries of a ratio for a file; its value is null where it is not reported."""
    return {"ratio": ratio.value, "spread": ratio.spread, "goal": ratio.goal}


def machine() -> dict[str, str]:
    """Entries for a file about where it was measured."""
    return {
        "machine": platform.processor() or platform.machine(),
        "python": platform.python_version(),
    }
