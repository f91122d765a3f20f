"""Sine, cosine and tangent."""

from __future__ import annotations

from math import inf, nan

from ev_core.elementary.parts import QUARTER_PI, QUARTER_PI_TAIL, upper_half
from ev_core.elementary.reduction import reduced
from ev_msgs_py.compilable import compilable

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


# Follows fdlibm, whose notice this is:
# Copyright (C) 1993 by Sun Microsystems, Inc. All rights reserved.
# Developed at SunSoft, a Sun Microsystems, Inc. business.
# Permission to use, copy, modify, and distribute this software is freely granted, provided that this notice is
# preserved.

WIDE = 0.67434
T0 = 3.33333333333334091986e-01
T1 = 1.33333333333201242699e-01
T2 = 5.39682539762260521377e-02
T3 = 2.18694882948595424599e-02
T4 = 8.86323982359930005737e-03
T5 = 3.59207910759131235356e-03
T6 = 1.45620945432529025516e-03
T7 = 5.88041240820264096874e-04
T8 = 2.46463134818469906812e-04
T9 = 7.81794442939557092300e-05
T10 = 7.14072491382608190305e-05
T11 = -1.85586374855275456654e-05
T12 = 2.59073051863633712884e-05


@compilable
def tan(x: float) -> float:
    """Tangent of any angle, exactly odd, NaN at ±inf; 0.86 ulp."""
    if -QUARTER_PI <= x <= QUARTER_PI:
        return near_tangent(0, x, 0.0) if x > 1e-8 or x < -1e-8 else x
    if not -inf < x < inf:
        return nan
    n, rest, tail = reduced(x)
    return near_tangent(n & 1, rest, tail)


@compilable
def near_tangent(n: int, x: float, tail: float) -> float:
    """Tangent of x + tail for |x| <= pi/4, and of a quarter turn more for n = 1; fdlibm's k_tan.c."""
    size = abs(x)
    if size >= WIDE:
        signed_tail = tail if x > 0.0 else -tail
        t, rest = series((QUARTER_PI - size) + (QUARTER_PI_TAIL - signed_tail), 0.0)
        y = t + rest
        one = -1.0 if n else 1.0
        result = one - 2.0 * (t - (y * y / (y + one) - rest))
        return result if x > 0.0 else -result
    t, rest = series(x, tail)
    y = t + rest
    if not n:
        return y
    # -1/(t + rest), with what the rounding of the quotient misses.
    head = upper_half(y)
    behind = rest - (head - t)
    quotient = -1.0 / y
    upper = upper_half(quotient)
    return upper + quotient * ((1.0 + upper * head) + upper * behind)


@compilable
def series(x: float, tail: float) -> tuple[float, float]:
    """Return x and what the tangent of x + tail is more than x, for |x| < WIDE."""
    z = x * x
    w = z * z
    odd = T1 + w * (T3 + w * (T5 + w * (T7 + w * (T9 + w * T11))))
    even = z * (T2 + w * (T4 + w * (T6 + w * (T8 + w * (T10 + w * T12)))))
    cube = z * x
    return x, tail + z * (cube * (odd + even) + tail) + T0 * cube
