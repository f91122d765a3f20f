"""Milliseconds of the wall clock, counted."""

from __future__ import annotations

import time

from ev_msgs_py.can.schedule import TICK


class Ticks:
    """Begins to count when it is made; the clock is monotonic."""

    def __init__(self) -> None:
        self._start, self._counted = time.monotonic(), 0

    def passed(self) -> int:
        """Ticks since the last call; many, if the process was held up."""
        passed = int((time.monotonic() - self._start) / TICK) - self._counted
        self._counted += passed
        return passed

    def until_next(self) -> float:
        """Seconds until the next one."""
        return max(self._start + (self._counted + 1) * TICK - time.monotonic(), 0.0)
