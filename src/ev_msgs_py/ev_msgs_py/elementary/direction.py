"""The angle of a vector in the plane."""

from __future__ import annotations

from math import copysign, inf

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.elementary.arc_tangent import ATAN_HALF, ATAN_HALF_TAIL, arc_excess
from ev_msgs_py.elementary.parts import HALF_PI, HALF_PI_TAIL, PI, PI_TAIL, QUARTER_PI, QUARTER_PI_TAIL, upper_half

# Between these the products of Dekker's division are exact; a quotient below NEGLIGIBLE is its own arc tangent.
SMALL, LARGE = 1e-250, 1e290
FAR, NEGLIGIBLE = 2.0**-60, 2.0**-28
UP = 2.0**400

# The angle from which the rest is counted, in two parts: by octant (the rest is added in the first and third) and by
# the tangent's interval about 0, 1/2, 1.
HEADS = (
    *(0.0, ATAN_HALF, QUARTER_PI),
    *(HALF_PI, 1.1071487177940904, QUARTER_PI),
    *(HALF_PI, 2.0344439357957027, 3 * QUARTER_PI),
    *(PI, 2.677945044588987, 3 * QUARTER_PI),
)
TAILS = (
    *(0.0, ATAN_HALF_TAIL, QUARTER_PI_TAIL),
    *(HALF_PI_TAIL, 9.40447137356638e-17, QUARTER_PI_TAIL),
    *(HALF_PI_TAIL, 2.841996617907152e-17, 3 * QUARTER_PI_TAIL),
    *(PI_TAIL, 1.5527705369303147e-16, 3 * QUARTER_PI_TAIL),
)


@compilable
def atan2(y: float, x: float) -> float:
    """Angle of (x, y) from the x axis, -pi..pi, by the signs of zeros, too; 0.93 ulp.

    The smaller over the larger side by fdlibm's polynomial for atan; near the x axis the quotient is carried to twice
    the bits by Dekker's division (T. J. Dekker, Numerische Mathematik 18, 1971), else no rounding of it matters.
    """
    small, large = abs(y), abs(x)
    steep = small > large
    if steep:
        small, large = large, small
    if not (small > SMALL and large < LARGE):
        if not small > large * FAR or large == inf:
            return atan2_of_extremes(y, x)
        if large < 1.0:
            small *= UP
            large *= UP
        else:
            small /= UP
            large /= UP
    tail = 0.0
    if small < 0.4375 * large:
        i = 0
        t = small / large
        if not steep and x > 0.0:
            if t < NEGLIGIBLE:
                return t if y > 0.0 else -t
            head, high = upper_half(t), upper_half(large)
            tail = (head - t) + ((small - head * high) - head * (large - high)) / large
    elif small < 0.6875 * large:
        i = 1
        t = (2.0 * small - large) / (2.0 * large + small)
    else:
        i = 2
        t = (small - large) / (large + small)
    if steep:
        if x > 0.0:
            i += 3
            t = -t
        else:
            i += 6
    elif x < 0.0:
        i += 9
        t = -t
    result = HEADS[i] + (t - (arc_excess(t) - (TAILS[i] + tail)))
    return result if y > 0.0 else -result


@compilable
def atan2_of_extremes(y: float, x: float) -> float:
    """Angle where one side is zero, infinite, NaN or as good as nothing beside the other."""
    if x != x or y != y:
        return x + y
    right = copysign(1.0, x) > 0.0
    if y == 0.0:
        return y if right else copysign(PI, y)
    if abs(x) == abs(y):
        return copysign(QUARTER_PI if right else 3 * QUARTER_PI, y)
    if abs(y) > abs(x):
        return copysign(HALF_PI, y)
    return y / x if right else copysign(PI, y)
