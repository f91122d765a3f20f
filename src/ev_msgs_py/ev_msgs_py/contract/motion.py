"""What follows from the motion of the body alone."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.signals import BodyVelocity
from ev_msgs_py.elementary import copysign, hypot


@compilable
def speed_along_path(body: BodyVelocity) -> float:
    """Speed of the centre of mass along its path, negative in reverse [m/s]."""
    return copysign(hypot(body.longitudinal, body.lateral), body.longitudinal)
