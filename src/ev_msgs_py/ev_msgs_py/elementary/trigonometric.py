"""Sine and cosine."""

from __future__ import annotations

from math import inf, nan

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.elementary.parts import QUARTER_PI
from ev_msgs_py.elementary.reduction import reduced

# Follows fdlibm, whose notice this is:
# Copyright (C) 1993 by Sun Microsystems, Inc. All rights reserved.
# Developed at SunSoft, a Sun Microsystems, Inc. business.
# Permission to use, copy, modify, and distribute this software is freely granted, provided that this notice is
# preserved.

S1 = 1.66666666666666324348e-01
S2 = 8.33333333332248946124e-03
S3 = -1.98412698298579493134e-04
S4 = 2.75573137070700676789e-06
S5 = -2.50507602534068634195e-08
S6 = 1.58969099521155010221e-10
C1 = 4.16666666666666019037e-02
C2 = -1.38888888888741095749e-03
C3 = 2.48015872894767294178e-05
C4 = -2.75573143513906633035e-07
C5 = 2.08757232129817482790e-09
C6 = -1.13596475577881948265e-11


@compilable
def near_sine(x: float, tail: float) -> float:
    """Sine of x + tail for |x| <= pi/4; fdlibm's k_sin.c."""
    z = x * x
    series = S2 + z * (S3 + z * S4) + z * (z * z) * (S5 + z * S6)
    cube = z * x
    return x - ((z * (0.5 * tail - cube * series) - tail) + cube * S1)


@compilable
def near_cosine(x: float, tail: float) -> float:
    """Cosine of x + tail for |x| <= pi/4; fdlibm's k_cos.c."""
    z = x * x
    w = z * z
    series = z * (C1 + z * (C2 + z * C3)) + w * w * (C4 + z * (C5 + z * C6))
    half = 0.5 * z
    head = 1.0 - half
    return head + (((1.0 - head) - half) + (z * series - x * tail))


@compilable
def sin(x: float) -> float:
    """Sine of any angle, exactly odd, NaN at ±inf; 0.8 ulp."""
    if -QUARTER_PI <= x <= QUARTER_PI:
        return near_sine(x, 0.0) if x > 1e-8 or x < -1e-8 else x
    if not -inf < x < inf:
        return nan
    n, rest, tail = reduced(x)
    result = near_cosine(rest, tail) if n & 1 else near_sine(rest, tail)
    return -result if n & 2 else result


@compilable
def cos(x: float) -> float:
    """Cosine of any angle, exactly even, NaN at ±inf; 0.8 ulp."""
    if -QUARTER_PI <= x <= QUARTER_PI:
        return near_cosine(x, 0.0)
    if not -inf < x < inf:
        return nan
    n, rest, tail = reduced(x)
    result = near_sine(rest, tail) if n & 1 else near_cosine(rest, tail)
    return -result if (n + 1) & 2 else result


@compilable
def sin_cos(x: float) -> tuple[float, float]:
    """Sine and cosine of any angle, the same bits as one by one, for little more than the price of one."""
    if -QUARTER_PI <= x <= QUARTER_PI:
        return near_sine(x, 0.0) if x > 1e-8 or x < -1e-8 else x, near_cosine(x, 0.0)
    if not -inf < x < inf:
        return nan, nan
    n, rest, tail = reduced(x)
    sine, cosine = near_sine(rest, tail), near_cosine(rest, tail)
    if n & 1:
        sine, cosine = cosine, -sine
    return (-sine, -cosine) if n & 2 else (sine, cosine)
