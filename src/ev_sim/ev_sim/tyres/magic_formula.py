"""The Magic Formula."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import inlined
from ev_msgs_py.elementary import atan, sin


@inlined
def friction(slip: float, b: float, c: float, d: float, e: float) -> float:
    """Friction use over slip, mu = D sin(C atan(B S - E (B S - atan(B S)))).

    Slip S [1] is at least 0; stiffness factor B, shape factor C, peak D, curvature factor E [1]; returns [1].
    Source: Pacejka, Tire and Vehicle Dynamics, 3rd ed. 2012, section 4.3, without shifts.
    """
    bs = b * slip
    return d * sin(c * atan(bs - e * (bs - atan(bs))))
