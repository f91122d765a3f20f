"""When cyclic frames are due, counted in ticks of 1 ms."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.parameters.declaration import ParameterError

TICK = 0.001  # s


@compilable
def is_due(every: float, before: float, now: float) -> bool:
    """Whether a cycle of so many ticks ends after tick `before` and not after `now`; one of none is never due."""
    cycle = int(every)
    return cycle > 0 and int(now) // cycle > int(before) // cycle


def ticks_of(period: float, most: int) -> float:
    """How many ticks a control period [s] has; ParameterError unless it is 1 to `most` of them."""
    ticks = round(period / TICK)
    if not 1 <= ticks <= most or abs(period - ticks * TICK) > 1e-9:
        raise ParameterError(
            f"control_period: {period!r} is refused, allowed on a CAN bus are 1 to {most} cycles of {TICK:g} s"
        )
    return float(ticks)
