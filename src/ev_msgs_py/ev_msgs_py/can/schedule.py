"""When cyclic frames are due, counted in ticks of 1 ms."""

from __future__ import annotations

TICK = 0.001  # s


def is_due(cycle: float, before: int, now: int) -> bool:
    """Whether a cycle [s] ends after tick `before` and not after `now`; a frame without a cycle is never due."""
    every = round(cycle / TICK)
    return every > 0 and now // every > before // every
