"""When cyclic frames are due, counted in ticks of 1 ms."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import compilable

TICK = 0.001  # s


@compilable
def is_due(every: float, before: float, now: float) -> bool:
    """Whether a cycle of so many ticks ends after tick `before` and not after `now`; one of none is never due."""
    return every > 0.0 and now // every > before // every
