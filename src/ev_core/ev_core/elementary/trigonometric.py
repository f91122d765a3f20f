"""Sine, cosine and tangent of an angle, however many turns it has.

How it works: the angle becomes a number of quarter turns and a rest of at most an eighth of a turn.
Polynomials give sine and cosine of the rest; the quarter turns choose between them and their signs.
"""

from math import floor, frexp, inf, ldexp, nan

from ev_core.elementary.parts import (
    HALF_PI,
    HALF_PI_TAIL,
    QUARTER_PI,
    QUARTER_PI_TAIL,
    ROUND,
    upper_half,
)
from ev_msgs_py.compilable import compilable

UNIT, PER_UNIT = 2.0**24, 2.0**-24
HALF_PI_HIGH = upper_half(HALF_PI)
HALF_PI_LOW = HALF_PI - HALF_PI_HIGH
QUARTERS = 0.6366197723675814  # 2 / pi
# pi / 2 in parts of 33 bits, with exact multiples up to 2**20, each with the rest that is missing
# behind it.
PART_1, BEHIND_1 = 1.57079632673412561417, 6.07710050650619224932e-11
PART_2, PART_3, BEHIND_3 = (
    6.07710050630396597660e-11,
    2.02226624871116645580e-21,
    8.47842766036889956997e-32,
)
MODERATE = 2.0**20  # [rad], below 2**20 quarter turns
PLAIN = 1e-8  # a rest above this part of the quarters is not spoilt by cancellation
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


def _digits() -> tuple[float, ...]:
    """2/pi to 1200 bits: digits of 24 bits each from index 2 on, with zeros before the point."""
    bits = int(
        "a2f9836e4e441529fc2757d1f534ddc0db6295993c439041fe5163abdebbc561b7246e3a424dd2e0"
        "06492eea09d1921cfe1deb1cb129a73ee88235f52ebb4484e99c7026b45f7e413991d639835339f4"
        "9c845f8bbdf9283b1ff897ffde05980fef2f118b5a0a6d1f6d367ecf27cb09b74f463f669e5fea2d"
        "7527bac7ebe5f17b3d0739f78a5292ea6bfb5fb11f8d5d0856033046fc7b",
        16,
    )
    return 0.0, 0.0, *(float(bits >> 24 * (49 - i) & 0xFFFFFF) for i in range(50))


TWO_OVER_PI = _digits()


@compilable
def digit_of_product(x: tuple[float, float, float], at: int, carry: float) -> tuple[float, float]:
    """Return carry and digit of x times 2/pi at a place.

    `carry` comes from the place behind it.
    """
    total = x[0] * TWO_OVER_PI[at] + x[1] * TWO_OVER_PI[at - 1] + x[2] * TWO_OVER_PI[at - 2] + carry
    over = float(floor(total * PER_UNIT))
    return over, total - over * UNIT


@compilable
def reduced_huge(x: float) -> tuple[int, float, float]:
    """Return n, rest, tail for finite |x| >= 2**20.

    x = (n + 4 m) pi/2 + rest + tail with |rest| <= pi/4.

    The digits of x times those of 2/pi that neither give whole turns nor are too small to matter:
    M. Payne and R. Hanek, Radian Reduction for Trigonometric Functions, SIGNUM Newsletter 18, 1983;
    arranged as in K. C. Ng, Good to the Last Bit, 1992. Exact up to the product by pi/2, and no
    double is so close to a multiple of pi/2 that the digits left out show.
    """
    size, exponent = frexp(abs(x))
    size *= UNIT
    x0 = float(floor(size))
    size = (size - x0) * UNIT
    x1 = float(floor(size))
    digits = x0, x1, (size - x1) * UNIT
    exponent -= 24
    skipped = max((exponent - 3) // 24, 0)  # the digits before these only count whole turns
    at = skipped + 2
    unit = ldexp(1.0, exponent - 24 * (skipped + 1))

    carry, d7 = digit_of_product(digits, at + 7, 0.0)
    carry, d6 = digit_of_product(digits, at + 6, carry)
    carry, d5 = digit_of_product(digits, at + 5, carry)
    carry, d4 = digit_of_product(digits, at + 4, carry)
    carry, d3 = digit_of_product(digits, at + 3, carry)
    carry, d2 = digit_of_product(digits, at + 2, carry)
    carry, d1 = digit_of_product(digits, at + 1, carry)
    carry, d0 = digit_of_product(digits, at, carry)

    whole = (carry * UNIT + d0) * unit
    whole -= 4.0 * floor(0.25 * whole)
    whole += d1 * (unit * PER_UNIT)
    n = floor(whole + 0.5)
    whole -= n

    # The digits behind, as a sum of two numbers; then all together, with what the sum loses; then
    # times pi/2.
    unit *= PER_UNIT * PER_UNIT * PER_UNIT
    upper = (d2 * UNIT + d3) * unit
    unit *= PER_UNIT * PER_UNIT
    lower = (d4 * UNIT + d5) * unit
    behind = upper + lower
    lost = ((upper - behind) + lower) + (d6 * UNIT + d7) * (unit * PER_UNIT * PER_UNIT)
    total = whole + behind
    back = total - whole
    lost += (whole - (total - back)) + (behind - back)
    rest = total + lost
    rest, tail = times_half_pi(rest, (total - rest) + lost)
    n &= 3
    return (n, rest, tail) if x > 0.0 else (-n & 3, -rest, -tail)


@compilable
def times_half_pi(rest: float, tail: float) -> tuple[float, float]:
    """Both parts of the product of a number in two parts and pi/2.

    After T. J. Dekker, Numerische Mathematik 18, 1971.
    """
    product = rest * HALF_PI
    high = upper_half(rest)
    low = rest - high
    error = (
        (high * HALF_PI_HIGH - product) + high * HALF_PI_LOW + low * HALF_PI_HIGH
    ) + low * HALF_PI_LOW
    error += rest * HALF_PI_TAIL + tail * HALF_PI
    result = product + error
    return result, (product - result) + error


# Follows fdlibm; its notice: Copyright (C) 1993 by Sun Microsystems, Inc. All rights reserved.
# Developed at SunSoft, a Sun Microsystems, Inc. business. Permission to use, copy, modify, and
# distribute this software is freely granted, provided that this notice is preserved.


@compilable
def reduced(x: float) -> tuple[int, float, float]:
    """Return n, rest, tail: x = (n + 4 m) pi/2 + rest + tail with |rest| <= pi/4, for finite x.

    To 60 bits. W. J. Cody and W. Waite, Software Manual for the Elementary Functions, 1980, with
    the parts of pi/2 that fdlibm's e_rem_pio2.c has.
    """
    if not -MODERATE < x < MODERATE:
        return reduced_huge(x)
    quarters = (x * QUARTERS + ROUND) - ROUND
    first = x - quarters * PART_1
    behind = quarters * BEHIND_1
    rest = first - behind
    if abs(rest) > PLAIN * abs(quarters):
        return int(quarters) & 3, rest, (first - rest) - behind
    return reduced_again(int(quarters) & 3, first, quarters)


@compilable
def reduced_again(n: int, first: float, quarters: float) -> tuple[int, float, float]:
    """Count all parts of pi/2, with what each difference loses.

    After D. E. Knuth, TAOCP 2, 4.2.2, theorem B.
    """
    part = quarters * PART_2
    second = first - part
    back = second - first
    lost = (first - (second - back)) - (part + back)
    part = quarters * PART_3
    third = second - part
    back = third - second
    lost += (second - (third - back)) - (part + back)
    lost -= quarters * BEHIND_3
    rest = third + lost
    return n, rest, (third - rest) + lost


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
    """Sine and cosine of any angle, for little more than the price of one.

    The bits are those of `sin` and `cos`.
    """
    if -QUARTER_PI <= x <= QUARTER_PI:
        return near_sine(x, 0.0) if x > 1e-8 or x < -1e-8 else x, near_cosine(x, 0.0)
    if not -inf < x < inf:
        return nan, nan
    n, rest, tail = reduced(x)
    sine, cosine = near_sine(rest, tail), near_cosine(rest, tail)
    if n & 1:
        sine, cosine = cosine, -sine
    return (-sine, -cosine) if n & 2 else (sine, cosine)


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
    """Tangent of x + tail for |x| <= pi/4, and of a quarter turn more for n = 1.

    After fdlibm's k_tan.c.
    """
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
