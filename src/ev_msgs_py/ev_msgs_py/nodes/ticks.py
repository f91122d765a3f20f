"""Milliseconds of the wall clock, counted."""

from __future__ import annotations

import time

from ev_msgs_py.can.schedule import TICK

_LONGEST = 20  # ticks that are made good at once after the process was held up; what is beyond is lost


class Ticks:
    """Begins to count when it is made; the clock is monotonic."""

    def __init__(self) -> None:
        self._start, self._counted = time.monotonic(), 0

    def passed(self) -> int:
        """Ticks since the last call, at most what can be made good."""
        passed = int((time.monotonic() - self._start) / TICK) - self._counted
        self._counted += passed
        return min(passed, _LONGEST)

    def until_next(self) -> float:
        """Seconds until the next one."""
        return max(self._start + (self._counted + 1) * TICK - time.monotonic(), 0.0)
