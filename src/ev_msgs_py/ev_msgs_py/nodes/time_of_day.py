"""What the time of day may not do: be later than the middleware can say, or go back."""

from __future__ import annotations

import time

from rclpy.utilities import get_rmw_implementation_identifier

_LAST = 2**31 - 1  # s since 1970
_SET_BACK = 1_000_000  # ns: waits that last longer by less than that are nobody's trouble


def too_late() -> str | None:
    """One line if the middleware can send nothing at the time of day that it is: Fast DDS stamps it with 32 bits."""
    now = time.time()
    if now <= _LAST or not get_rmw_implementation_identifier().startswith("rmw_fastrtps"):
        return None
    here, last = (time.strftime("%Y-%m-%d %H:%M:%S", time.gmtime(instant)) for instant in (now, _LAST))
    return f"the time of day: {here} UTC is past what Fast DDS can send; allowed: up to {last}, or another middleware"


def refuse_late_time_of_day() -> None:
    """RuntimeError where the middleware could send nothing."""
    trouble = too_late()
    if trouble is not None:
        raise RuntimeError(trouble)


def ahead() -> int:
    """How far the time of day is ahead of the monotonic clock [ns]."""
    return time.time_ns() - time.monotonic_ns()


class SetBack:
    """Sees the time of day being set back, from look to look; the first is at `before`, as `ahead` gave it."""

    def __init__(self, before: int) -> None:
        self._before = before

    def is_seen(self) -> bool:
        """Whether it was set back since the last look."""
        before, self._before = self._before, ahead()
        return self._before < before - _SET_BACK
