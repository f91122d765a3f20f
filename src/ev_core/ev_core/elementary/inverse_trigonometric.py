"""Arc sine, arc cosine, arc tangent, and the angle of a vector in the plane."""

from math import copysign, inf, nan, sqrt

from ev_core.elementary.parts import (
    HALF_PI,
    HALF_PI_TAIL,
    PI,
    PI_TAIL,
    QUARTER_PI,
    QUARTER_PI_TAIL,
    upper_half,
)
from ev_msgs_py.compilable import compilable

# Follows fdlibm; its notice: Copyright (C) 1993 by Sun Microsystems, Inc. All rights reserved.
# Developed at SunSoft, a Sun Microsystems, Inc. business. Permission to use, copy, modify, and
# distribute this software is freely granted, provided that this notice is preserved.

P0 = 1.66666666666666657415e-01
P1 = -3.25565818622400915405e-01
P2 = 2.01212532134862925881e-01
P3 = -4.00555345006794114027e-02
P4 = 7.91534994289814532176e-04
P5 = 3.47933107596021167570e-05
Q1 = -2.40339491173441421878e00
Q2 = 2.02094576023350569471e00
Q3 = -6.88283971605453293030e-01
Q4 = 7.70381505559019352791e-02
ATAN_HALF, ATAN_HALF_TAIL = 4.63647609000806093515e-01, 2.26987774529616870924e-17
ATAN_3_HALVES, ATAN_3_HALVES_TAIL = 9.82793723247329054082e-01, 1.39033110312309984516e-17
A0 = 3.33333333333329318027e-01
A1 = -1.99999999998764832476e-01
A2 = 1.42857142725034663711e-01
A3 = -1.11111104054623557880e-01
A4 = 9.09088713343650656196e-02
A5 = -7.69187620504482999495e-02
A6 = 6.66107313738753120669e-02
A7 = -5.83357013379057348645e-02
A8 = 4.97687799461593236017e-02
A9 = -3.65315727442169155270e-02
A10 = 1.62858201153657823623e-02
# Between these the products of Dekker's division are exact; a quotient below NEGLIGIBLE is its own
# arc tangent.
SMALL, LARGE = 1e-250, 1e290
FAR, NEGLIGIBLE = 2.0**-60, 2.0**-28
UP = 2.0**400
# The angle from which the rest is counted, in two parts: by octant (the rest is added in the first
# and third) and by the tangent's interval about 0, 1/2, 1.
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
def arc_sine_series(z: float) -> float:
    """(asin(s) - s)/s with z = s²; for z <= 1/4."""
    over = z * (P0 + z * (P1 + z * (P2 + z * (P3 + z * (P4 + z * P5)))))
    return over / (1.0 + z * (Q1 + z * (Q2 + z * (Q3 + z * Q4))))


@compilable
def asin(x: float) -> float:
    """Arc sine, NaN beyond ±1; 0.93 ulp; after fdlibm's e_asin.c."""
    size = abs(x)
    if size < 0.5:
        return x + x * arc_sine_series(x * x) if size > 1e-8 else x
    if not size <= 1.0:
        return nan
    z = (1.0 - size) * 0.5
    s = sqrt(z)
    series = arc_sine_series(z)
    if size > 0.975:
        result = HALF_PI - (2.0 * (s + s * series) - HALF_PI_TAIL)
    else:
        head = upper_half(s)
        tail = (z - head * head) / (s + head)
        p = 2.0 * s * series - (HALF_PI_TAIL - 2.0 * tail)
        result = QUARTER_PI - (p - (QUARTER_PI - 2.0 * head))
    return result if x > 0.0 else -result


@compilable
def acos(x: float) -> float:
    """Arc cosine, NaN beyond ±1; 0.91 ulp; after fdlibm's e_acos.c."""
    if -0.5 < x < 0.5:
        return HALF_PI - (x - (HALF_PI_TAIL - x * arc_sine_series(x * x)))
    if 0.5 <= x < 1.0:
        z = (1.0 - x) * 0.5
        s = sqrt(z)
        head = upper_half(s)
        tail = (z - head * head) / (s + head)
        return 2.0 * (head + (arc_sine_series(z) * s + tail))
    if -1.0 <= x <= -0.5:
        z = (1.0 + x) * 0.5
        s = sqrt(z)
        return PI - 2.0 * (s + (arc_sine_series(z) * s - HALF_PI_TAIL))
    return 0.0 if x == 1.0 else nan


@compilable
def arc_excess(t: float) -> float:
    """Difference t - atan(t), for |t| <= 7/16."""
    z = t * t
    w = z * z
    odd = z * (A0 + w * (A2 + w * (A4 + w * (A6 + w * (A8 + w * A10)))))
    even = w * (A1 + w * (A3 + w * (A5 + w * (A7 + w * A9))))
    return t * (odd + even)


@compilable
def atan(x: float) -> float:
    """Arc tangent; 0.86 ulp; from those of 1/2, 1, 3/2, infinity and a polynomial for the rest.

    After fdlibm's s_atan.c.
    """
    size = abs(x)
    if size < 0.4375:
        return x - arc_excess(x) if size > 1e-8 else x
    if size < 1.1875:
        if size < 0.6875:
            t = (2.0 * size - 1.0) / (2.0 + size)
            result = ATAN_HALF - ((arc_excess(t) - ATAN_HALF_TAIL) - t)
        else:
            t = (size - 1.0) / (size + 1.0)
            result = QUARTER_PI - ((arc_excess(t) - QUARTER_PI_TAIL) - t)
    elif size < 2.4375:
        t = (size - 1.5) / (1.0 + 1.5 * size)
        result = ATAN_3_HALVES - ((arc_excess(t) - ATAN_3_HALVES_TAIL) - t)
    else:
        t = -1.0 / size
        result = HALF_PI - ((arc_excess(t) - HALF_PI_TAIL) - t)
    return result if x > 0.0 else -result


@compilable
def atan2(y: float, x: float) -> float:
    """Angle of (x, y) from the x axis, -pi..pi, by the signs of zeros, too; 0.93 ulp.

    The smaller over the larger side by fdlibm's polynomial for atan; near the x axis the quotient
    is carried to twice the bits by Dekker's division (T. J. Dekker, Numerische Mathematik 18,
    1971), else no rounding of it matters.
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
