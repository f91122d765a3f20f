"""Exponential function, logarithm, expm1, log1p and the hyperbolic functions."""

from math import frexp, inf, isqrt, ldexp, nan

from ev_core.elementary.parts import ROUND, upper_half
from ev_msgs_py.compilable import compilable

COUNT = 32
_BITS = 200
# 2**k is COARSE[(k >> 5) + COARSE_ZERO] * (1 << (k & 31)) for -1022 <= k <= 1023.
COARSE_ZERO = 32
STEPS = 46.16624130844683  # 32 / ln 2
STEP_HEAD = 0.021660849392446835  # ln 2 / 32, to 37 bits, so that up to 2**16 steps are exact,
STEP_TAIL = 5.145609244655338e-14  # and the rest of it
LOWEST, HIGHEST = -708.0, 709.7  # where 2**k is a normal number
UNDERFLOW, OVERFLOW = -746.0, 709.782712893384  # beyond, the result is 0 or infinite
LIFT, UNLIFT = 32 * 100, 2.0**-100
C3, C4, C5, C6 = 1.0 / 6.0, 1.0 / 24.0, 1.0 / 120.0, 1.0 / 720.0
# Where e**x - 1 is formed directly, without e**x: up to ln(2) / 2.
NEAR_ZERO = 0.3465735902799726
Q1 = -3.33333333333331316428e-02
Q2 = 1.58730158725481460165e-03
Q3 = -7.93650757867487942473e-05
Q4 = 4.00821782732936239552e-06
Q5 = -2.01099218183624371326e-07
# exp(x) / 2 is both sinh and cosh to all bits from here on; above HALVED_FROM it must not overflow
# before it is halved.
LARGE, HALVED_FROM = 22.0, 709.0
# Taylor's series of sinh.
S3, S5, S7, S9 = 1 / 6, 1 / 120, 1 / 5040, 1 / 362880
S11, S13, S15, S17, S19 = (
    1 / 39916800,
    1 / 6227020800,
    1 / 1307674368000,
    1 / 355687428096000,
    1 / 121645100408832000,
)
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


def _roots() -> tuple[tuple[float, ...], tuple[float, ...]]:
    """2**(j/32), j = 0..31, as doubles and what these miss.

    They come from integers, so without rounding that could differ.
    """
    unit = 1 << _BITS
    step = 2 * unit
    for _ in range(5):
        step = isqrt(step * unit)
    heads, tails = [], []
    power = unit
    for _ in range(COUNT):
        head = power / unit
        heads.append(head)
        tails.append((power - (int(ldexp(head, 52)) << (_BITS - 52))) / unit)
        power = power * step // unit
    return tuple(heads), tuple(tails)


HEADS, TAILS = _roots()

COARSE = tuple(ldexp(1.0, 32 * k) for k in range(-COARSE_ZERO, 32))


# Follows fdlibm; its notice: Copyright (C) 1993 by Sun Microsystems, Inc. All rights reserved.
# Developed at SunSoft, a Sun Microsystems, Inc. business. Permission to use, copy, modify, and
# distribute this software is freely granted, provided that this notice is preserved. (The
# coefficients Q of expm1, and the logarithms; the exponential function is after Tang.)


@compilable
def parts_of_exp(x: float, lift: int) -> tuple[float, float, float]:
    """Return head, tail, scale.

    e**x 2**(lift/32) = (head + tail) scale, to about 60 bits, scale a power of two.
    """
    steps = (x * STEPS + ROUND) - ROUND
    rest = (x - steps * STEP_HEAD) - steps * STEP_TAIL
    square = rest * rest
    more = rest + square * ((0.5 + rest * C3) + square * ((C4 + rest * C5) + square * C6))
    n = int(steps) + lift
    j = n & 31
    k = n >> 5
    head = HEADS[j]
    return head, TAILS[j] + head * more, COARSE[(k >> 5) + COARSE_ZERO] * (1 << (k & 31))


@compilable
def exp(x: float) -> float:
    """e**x; 0.56 ulp, 0.75 where the result is subnormal.

    By 2**(j/32) from a table and a polynomial for the rest: P. T. P. Tang, Table-Driven
    Implementation of the Exponential Function in IEEE Floating-Point Arithmetic, ACM TOMS 15, 1989;
    the polynomial is Taylor's.
    """
    if LOWEST < x < HIGHEST:
        head, tail, scale = parts_of_exp(x, 0)
        return (head + tail) * scale
    if UNDERFLOW < x <= OVERFLOW:
        if x < 0.0:
            head, tail, scale = parts_of_exp(x, LIFT)
            return (head + tail) * scale * UNLIFT
        head, tail, scale = parts_of_exp(x, -LIFT)
        return (head + tail) * scale / UNLIFT
    if x < 0.0:
        return 0.0
    return x + inf


@compilable
def expm1(x: float) -> float:
    """e**x - 1, accurate near zero, too; 0.78 ulp.

    Near zero by the rational function of fdlibm (s_expm1.c), elsewhere from e**x with 60 bits.
    """
    if -NEAR_ZERO <= x <= NEAR_ZERO:
        if -1e-17 < x < 1e-17:
            return x
        half = 0.5 * x
        h = x * half
        r = 1.0 + h * (Q1 + h * (Q2 + h * (Q3 + h * (Q4 + h * Q5))))
        t = 3.0 - r * half
        return x - (x * (h * ((r - t) / (6.0 - x * t))) - h)
    if -40.0 < x < 60.0:
        head, tail, scale = parts_of_exp(x, 0)
        high = head + tail
        low = ((head - high) + tail) * scale
        high *= scale
        result = high - 1.0
        missing = (high - result) - 1.0 if high > 1.0 else high - (1.0 + result)
        return result + (missing + low)
    if x < 0.0:
        return -1.0
    return exp(x)


@compilable
def tanh(x: float) -> float:
    """Hyperbolic tangent; 0.89 ulp.

    Up to 0.55 by eight steps of Lambert's continued fraction x/(1 + x²/(3 + x²/(5 + ...))) (J. H.
    Lambert, 1768), less its first term x; from there 1 - 2/(e**2x + 1), with what the sum e**2x + 1
    loses made good.
    """
    size = abs(x)
    if size < 0.55:
        z = x * x
        over = z * (675675.0 + z * (45045.0 + z * (594.0 + z)))
        under = 2027025.0 + z * (945945.0 + z * (51975.0 + z * (630.0 + z)))
        return x - x * (over / under) if size > 1e-9 else x
    if size < LARGE:
        head, tail, scale = parts_of_exp(2.0 * size, 0)
        high = (head + tail) * scale
        total = high + 1.0
        lost = ((high - total) + 1.0) + ((head * scale - high) + tail * scale)
        part = 2.0 / total
        less = part * (lost / total)
        result = 0.5 + ((0.5 - part) + less) if part > 0.25 else 1.0 - (part - less)
    elif size >= LARGE:
        result = 1.0
    else:
        return x
    return result if x > 0.0 else -result


@compilable
def sinh(x: float) -> float:
    """Hyperbolic sine; 0.87 ulp.

    Up to 1 by Taylor's series, from there (e**x - e**-x)/2, with e**x to 60 bits.
    """
    size = abs(x)
    if size < 1.0:
        z = x * x
        series = S9 + z * (S11 + z * (S13 + z * (S15 + z * (S17 + z * S19))))
        return x + x * (z * (S3 + z * (S5 + z * (S7 + z * series)))) if size > 1e-9 else x
    if size < LARGE:
        head, tail, scale = parts_of_exp(size, 0)
        scale *= 0.5
        head *= scale
        tail *= scale
        result = head + (tail - 0.25 / (head + tail))
    else:
        result = half_exp(size)
    return result if x > 0.0 else -result


@compilable
def cosh(x: float) -> float:
    """Hyperbolic cosine; 0.88 ulp: (e**x + e**-x)/2, with e**x to 60 bits."""
    size = abs(x)
    if size < LARGE:
        head, tail, scale = parts_of_exp(size, 0)
        scale *= 0.5
        head *= scale
        tail *= scale
        return head + (tail + 0.25 / (head + tail))
    return half_exp(size)


@compilable
def half_exp(x: float) -> float:
    """exp(x)/2, finite where exp(x) no longer is."""
    if x < HALVED_FROM:
        return 0.5 * exp(x)
    if x < 711.0:
        head, tail, scale = parts_of_exp(x, -64)
        return (head + tail) * scale * 2.0
    return x * 1e308


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
    """log(1 + x), accurate near zero, too; -inf at -1, NaN below; 0.86 ulp.

    After fdlibm's s_log1p.c.
    """
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

    By fdlibm's series of the logarithm, which is one of atanh; the quotient with what its rounding
    misses, found by Dekker's exact product (T. J. Dekker, Numerische Mathematik 18, 1971).
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
