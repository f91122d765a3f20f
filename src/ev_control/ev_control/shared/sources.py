"""Where a law takes what no sensor of a car measures: from the simulated truth, or from its own estimate."""

from __future__ import annotations

SOURCES = ("truth", "estimated")
TRUTH, ESTIMATED = range(len(SOURCES))
