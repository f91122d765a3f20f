"""Arc sine and arc cosine."""

from __future__ import annotations

from math import nan, sqrt

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.elementary.parts import HALF_PI, HALF_PI_TAIL, PI, QUARTER_PI, upper_half

# Follows fdlibm, whose notice this is:
# Copyright (C) 1993 by Sun Microsystems, Inc. All rights reserved.
# Developed at SunSoft, a Sun Microsystems, Inc. business.
# Permission to use, copy, modify, and distribute this software is freely granted, provided that this notice is
# preserved.

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
