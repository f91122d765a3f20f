"""The friction curve of Burckhardt."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import inlined
from ev_msgs_py.elementary import exp


@inlined
def friction(slip: float, c1: float, c2: float, c3: float, _unused: float) -> float:
    """Friction use over slip, phi = C1 (1 - exp(-C2 S)) - C3 S.

    Slip S [1] is at least 0; returns [1]. Source: dissertation, table 2.3; Kiencke & Nielsen, Automotive Control
    Systems, 2nd ed. 2005, chapter on vehicle modelling.
    """
    return c1 * (1.0 - exp(-c2 * slip)) - c3 * slip
