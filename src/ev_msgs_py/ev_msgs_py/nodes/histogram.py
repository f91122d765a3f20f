"""Times, counted in bins."""

from __future__ import annotations

from bisect import bisect_right
from typing import Any

EDGES = tuple(digit * 10.0**power for power in range(-6, 1) for digit in (1.0, 2.0, 5.0))  # s, lower ends of bins


class Histogram:
    """Counts times [s] in three bins a decade from 1 us to 5 s and above; what is less is in the first."""

    def __init__(self) -> None:
        self.counts = [0] * (len(EDGES) + 1)
        self.largest = 0.0

    def add(self, seconds: float) -> None:
        """Count a time."""
        self.counts[bisect_right(EDGES, seconds)] += 1
        if seconds > self.largest:
            self.largest = seconds

    def as_json(self) -> dict[str, Any]:
        """Lower ends of the bins but the first [s], counts of all, and the largest time [s]."""
        return {"edges": list(EDGES), "counts": self.counts, "largest": self.largest}
