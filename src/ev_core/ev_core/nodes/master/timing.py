"""How well real time was kept, with its times counted in bins."""

from __future__ import annotations

import time
from bisect import bisect_right
from typing import Any

from ev_msgs_py.contract.topics import TOPICS

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


class Timing:
    """Wall times of a run in real time, all by the monotonic clock.

    `period` is that between steps, `lateness` how long after it was due a step was taken, `arrival` by topic how long
    after its instant was due an input came. An overrun is a step that came more than a period late; `without_command`
    counts the steps whose torque had faded since there was no command that was new enough, `refused` inputs by topic
    whose stamps were older than others before, or of instants that have yet to come.
    """

    def __init__(self, reads: tuple[type, ...]) -> None:
        self.steps = self.overruns = self.without_command = 0
        self.period, self.lateness = Histogram(), Histogram()
        self.arrival = {kind: Histogram() for kind in reads}
        self.refused = dict.fromkeys(reads, 0)
        self._stepped: float | None = None

    def stepped(self, lateness: float) -> None:
        """A step was taken now."""
        now = time.monotonic()
        if self._stepped is not None:
            self.period.add(now - self._stepped)
        self._stepped = now
        self.steps += 1
        self.lateness.add(lateness)

    def rested(self) -> None:
        """Time stood still until now: that was no period."""
        self._stepped = None

    def as_json(self) -> dict[str, Any]:
        """All of it; times in seconds."""
        return {
            "steps": self.steps,
            "overruns": self.overruns,
            "without_command": self.without_command,
            "refused": {TOPICS[kind].name: count for kind, count in self.refused.items()},
            "period": self.period.as_json(),
            "lateness": self.lateness.as_json(),
            "arrival": {TOPICS[kind].name: histogram.as_json() for kind, histogram in self.arrival.items()},
        }
