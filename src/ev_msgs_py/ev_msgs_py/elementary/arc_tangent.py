"""The arc tangent of a number."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.elementary.parts import HALF_PI, HALF_PI_TAIL, QUARTER_PI, QUARTER_PI_TAIL

# Follows fdlibm, whose notice this is:
# Copyright (C) 1993 by Sun Microsystems, Inc. All rights reserved.
# Developed at SunSoft, a Sun Microsystems, Inc. business.
# Permission to use, copy, modify, and distribute this software is freely granted, provided that this notice is
# preserved.

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


@compilable
def arc_excess(t: float) -> float:
    """What atan(t) falls short of t, for |t| <= 7/16."""
    z = t * t
    w = z * z
    odd = z * (A0 + w * (A2 + w * (A4 + w * (A6 + w * (A8 + w * A10)))))
    even = w * (A1 + w * (A3 + w * (A5 + w * (A7 + w * A9))))
    return t * (odd + even)


@compilable
def atan(x: float) -> float:
    """Arc tangent; 0.86 ulp; from those of 1/2, 1, 3/2, infinity and a polynomial for the rest: fdlibm's s_atan.c."""
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
