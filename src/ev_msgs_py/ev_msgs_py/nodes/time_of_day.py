"""Up to when the middleware can say what time it is."""

from __future__ import annotations

import time

from rclpy.utilities import get_rmw_implementation_identifier

_LAST = 2**31 - 1  # s since 1970


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
