"""The exponential function, and the exponential function less one."""

from __future__ import annotations

from math import inf

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.elementary.parts import ROUND
from ev_msgs_py.elementary.roots_of_two import COARSE, COARSE_ZERO, HEADS, TAILS

# Follows fdlibm, whose notice this is:
# Copyright (C) 1993 by Sun Microsystems, Inc. All rights reserved.
# Developed at SunSoft, a Sun Microsystems, Inc. business.
# Permission to use, copy, modify, and distribute this software is freely granted, provided that this notice is
# preserved.
# (The coefficients Q of expm1; the rest is after Tang.)

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


@compilable
def parts_of_exp(x: float, lift: int) -> tuple[float, float, float]:
    """Return head, tail, scale: e**x 2**(lift/32) = (head + tail) scale, to about 60 bits, scale a power of two."""
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

    By 2**(j/32) from a table and a polynomial for the rest: P. T. P. Tang, Table-Driven Implementation of the
    Exponential Function in IEEE Floating-Point Arithmetic, ACM TOMS 15, 1989; the polynomial is Taylor's.
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
