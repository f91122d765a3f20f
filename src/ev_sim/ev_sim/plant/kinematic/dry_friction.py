"""Motion of a mass under a force and dry friction, with a real stick phase."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.elementary import copysign


@compilable
def move_with_dry_friction(
    speed: float, force: float, friction: float, mass: float, duration: float
) -> tuple[float, float]:
    """Speed [m/s] and travelled distance [m] after `duration` [s] of m V' = F - F_friction sgn(V).

    The force is constant, `friction` >= 0 and `mass` > 0. Exact: a motion that friction brings to rest stops at its
    instant; at rest friction takes up any force within +-`friction`, a larger one breaks loose in its own direction.
    """
    distance = 0.0
    if speed != 0.0:
        acceleration = (force - copysign(friction, speed)) / mass
        stops = speed * acceleration < 0.0 and -speed / acceleration <= duration
        if not stops:
            return speed + acceleration * duration, (speed + acceleration * duration / 2.0) * duration
        distance = -speed * speed / (2.0 * acceleration)
        duration += speed / acceleration
    if abs(force) <= friction:
        return 0.0, distance
    acceleration = (force - copysign(friction, force)) / mass
    return acceleration * duration, distance + acceleration * duration * duration / 2.0
