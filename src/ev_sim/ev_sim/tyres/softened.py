"""A tyre that has become softer: its friction curve, stretched along the slip."""

from __future__ import annotations

from typing import Any

from ev_msgs_py.compiling.compilable import compilable
from ev_sim.tyres.curve import BURCKHARDT, LINEAR, MAGIC_FORMULA, MF_TYRE, RATIONAL, TWO_EXPONENTIAL


@compilable
def soften(curve: float, tyre: Any, share: float) -> None:
    """Let a record with the coefficients c0 to c3 of a curve give at a slip what it gave at `share` [1] of it.

    The slope at zero slip is `share` of what it was, the peak is as high as before.
    """
    if curve == BURCKHARDT:
        tyre.c1 *= share
        tyre.c2 *= share
    elif curve == RATIONAL:
        tyre.c1 /= share
    elif curve == TWO_EXPONENTIAL:
        tyre.c1 /= share
        tyre.c2 /= share
    elif curve in (MAGIC_FORMULA, LINEAR):
        tyre.c0 *= share
    elif curve == MF_TYRE:
        tyre.c1 *= share
