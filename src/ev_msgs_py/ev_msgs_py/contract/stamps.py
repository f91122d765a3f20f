"""Stamps as whole nanoseconds, in which steps can be compared exactly."""

from typing import Any

NANOSECONDS = 1_000_000_000
# The n-th run after a reset has stamps of n RUN above its instants, and below RUNS; no control
# period is shorter.
RUN = 10  # ns; a stamp that was computed in seconds may be 1 ns off, which is no other run
RUNS = 100_000  # ns
LAST_EXACT = 1 << 53  # ns; stamps above it, of more than a hundred days, are no exact float64


def from_seconds(seconds: float) -> int:
    """Whole nanoseconds nearest to a time in seconds."""
    return round(seconds * NANOSECONDS)


def to_seconds(stamp: int) -> float:
    """The float nearest to a stamp, in seconds."""
    return stamp / NANOSECONDS


def read(time: Any) -> int:
    """The stamp in a builtin_interfaces/Time."""
    stamp: int = time.sec * NANOSECONDS + time.nanosec
    return stamp
