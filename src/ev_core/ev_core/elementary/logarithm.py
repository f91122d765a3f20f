"""The logarithm, the logarithm of one more, and half the logarithm of (1 + x)/(1 - x)."""

from __future__ import annotations

from math import frexp, inf, nan

from ev_core.elementary.parts import upper_half
from ev_msgs_py.compilable import compilable

# Follows fdlibm, whose notice this is:
# Copyright (C) 1993 by Sun Microsystems, Inc. All rights reserved.
# Developed at SunSoft, a Sun Microsystems, Inc. business.
# Permission to use, copy, modify, and distribute this software is freely granted, provided that this notice is
# preserved.

LN2_HEAD = 6.93147180369123816490e-01  # to 32 bits, so that multiples by an exponent are exact, and
LN2_TAIL = 1.90821492927058770002e-10  # the rest of it
SQRT_HALF, SQRT_2 = 0.7071067811865476, 1.4142135623730951
L1 = 6.666666666666735130e-01
L2 = 3.999999999940941908e-01
L3 = 2.857142874366239149e-01
L4 = 2.222219843214978396e-01
L5 = 1.818357216161805012e-01
L6 = 1.531383769920937332e-01
L7 = 1.479819860511658591e-01


@compilable
def log_series(z: float) -> float:
    """(log((1 + s)/(1 - s)) - 2 s)/s with z = s²; for |s| <= 3 - 2 sqrt(2)."""
    w = z * z
    return z * (L1 + w * (L3 + w * (L5 + w * L7))) + w * (L2 + w * (L4 + w * L6))


@compilable
def log_of(x: float, more: float) -> float:
    """log(x) + more for positive, finite x and a small correction."""
    k = 0.0
    if not SQRT_HALF < x < SQRT_2:
        x, exponent = frexp(x)
        if x < SQRT_HALF:
            x *= 2.0
            exponent -= 1
        k = float(exponent)
    f = x - 1.0
    s = f / (2.0 + f)
    h = 0.5 * f * f
    return k * LN2_HEAD - ((h - (s * (h + log_series(s * s)) + (k * LN2_TAIL + more))) - f)


@compilable
def log(x: float) -> float:
    """Natural logarithm, -inf at zero, NaN below; 0.86 ulp; after fdlibm's e_log.c."""
    if 0.0 < x < inf:
        return log_of(x, 0.0)
    if x == 0.0:
        return -inf
    if x < 0.0:
        return nan
    return x


@compilable
def log1p(x: float) -> float:
    """log(1 + x), accurate near zero, too; -inf at -1, NaN below; 0.86 ulp; after fdlibm's s_log1p.c."""
    if -0.29 < x < 0.41:
        if -1e-17 < x < 1e-17:
            return x
        s = x / (2.0 + x)
        h = 0.5 * x * x
        return x - (h - s * (h + log_series(s * s)))
    if -1.0 < x < inf:
        total = 1.0 + x
        lost = 1.0 - (total - x) if x > 1.0 else x - (total - 1.0)
        return log_of(total, lost / total)
    if x == -1.0:
        return -inf
    if x < -1.0:
        return nan
    return x


@compilable
def atanh(x: float) -> float:
    """Inverse hyperbolic tangent: log((1 + x)/(1 - x))/2, infinite at ±1, NaN beyond; 0.87 ulp.

    By fdlibm's series of the logarithm, which is one of atanh; the quotient with what its rounding misses, found by
    Dekker's exact product (T. J. Dekker, Numerische Mathematik 18, 1971).
    """
    size = abs(x)
    if size < 0.17:
        return x + x * (0.5 * log_series(x * x)) if size > 1e-9 else x
    if size < 1.0:
        above, below = 1.0 + size, 1.0 - size
        quotient = above / below
        q1, b1 = upper_half(quotient), upper_half(below)
        q2, b2 = quotient - q1, below - b1
        left = ((above - q1 * b1) - q1 * b2) - q2 * b1 - q2 * b2
        left += (size - (above - 1.0)) - quotient * ((1.0 - below) - size)
        result = 0.5 * log_of(quotient, left / above)
    elif size == 1.0:
        result = inf
    else:
        return nan
    return result if x > 0.0 else -result
