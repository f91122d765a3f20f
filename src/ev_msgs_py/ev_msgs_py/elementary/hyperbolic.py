"""Hyperbolic sine, cosine and tangent."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.elementary.exponential import exp, parts_of_exp

# exp(x) / 2 is both sinh and cosh to all bits from here on; above HIGHEST it must not overflow before it is halved.
LARGE, HIGHEST = 22.0, 709.0

# Taylor's series of sinh.
S3, S5, S7, S9 = 1 / 6, 1 / 120, 1 / 5040, 1 / 362880
S11, S13, S15, S17, S19 = 1 / 39916800, 1 / 6227020800, 1 / 1307674368000, 1 / 355687428096000, 1 / 121645100408832000


@compilable
def tanh(x: float) -> float:
    """Hyperbolic tangent; 0.89 ulp.

    Up to 0.55 by eight steps of Lambert's continued fraction x/(1 + x²/(3 + x²/(5 + ...))) (J. H. Lambert, 1768),
    less its first term x; from there 1 - 2/(e**2x + 1), with what the sum e**2x + 1 loses made good.
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
    if x < HIGHEST:
        return 0.5 * exp(x)
    if x < 711.0:
        head, tail, scale = parts_of_exp(x, -64)
        return (head + tail) * scale * 2.0
    return x * 1e308
