"""Elementary functions whose bits do not depend on the machine (docs/elementary_functions.md).

The C library's sin, exp, ... round differently with and without FMA, from version to version and from system to system.
Ours are written with additions, multiplications, divisions and square roots in a fixed order, which IEEE 754 rounds in
one way only, so Python and compiled code give the same bits everywhere. All are at most 1 ulp off and raise nothing.

Those of `math` that stand here, too, are safe as they are: IEEE 754 wants `sqrt` correctly rounded, and the results of
`copysign`, `fabs`, `floor` and `isfinite` are exact. In Python `sqrt` of a negative number and `floor` of what is not
finite raise, while compiled they do not: ask before.
"""

from math import copysign, fabs, floor, isfinite, sqrt

from ev_msgs_py.elementary.arc_sine import acos, asin
from ev_msgs_py.elementary.arc_tangent import atan
from ev_msgs_py.elementary.direction import atan2
from ev_msgs_py.elementary.exponential import exp, expm1
from ev_msgs_py.elementary.hyperbolic import cosh, sinh, tanh
from ev_msgs_py.elementary.hypotenuse import hypot
from ev_msgs_py.elementary.logarithm import atanh, log, log1p
from ev_msgs_py.elementary.remainders import fmod, remainder
from ev_msgs_py.elementary.tangent import tan
from ev_msgs_py.elementary.trigonometric import cos, sin, sin_cos

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
