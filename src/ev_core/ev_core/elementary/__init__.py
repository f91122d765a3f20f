"""Elementary functions with the same bits on every machine (docs/elementary_functions.md).

The C library's sin, exp, ... round differently with and without FMA, from version to version and
from system to system. Ours are written with additions, multiplications, divisions and square roots
in a fixed order, which IEEE 754 rounds in one way only, so Python and compiled code give the same
bits everywhere. All are at most 1 ulp off and raise nothing.

Those of `math` among them are safe as they are: IEEE 754 wants `sqrt` correctly rounded, and the
results of `copysign`, `fabs`, `floor` and `isfinite` are exact. `sqrt` of a negative number and
`floor` of what is not finite raise; in compiled functions of ours they do not: ask before.
"""

from math import copysign, fabs, floor, isfinite, sqrt

from ev_core.elementary.exponential import atanh, cosh, exp, expm1, log, log1p, sinh, tanh
from ev_core.elementary.inverse_trigonometric import acos, asin, atan, atan2
from ev_core.elementary.parts import fmod, hypot, remainder
from ev_core.elementary.trigonometric import cos, sin, sin_cos, tan

__all__ = [
    "acos",
    "asin",
    "atan",
    "atan2",
    "atanh",
    "copysign",
    "cos",
    "cosh",
    "exp",
    "expm1",
    "fabs",
    "floor",
    "fmod",
    "hypot",
    "isfinite",
    "log",
    "log1p",
    "remainder",
    "sin",
    "sin_cos",
    "sinh",
    "sqrt",
    "tan",
    "tanh",
]
