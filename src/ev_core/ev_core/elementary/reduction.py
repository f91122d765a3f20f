"""An angle as a number of quarter turns and a rest of at most an eighth, however many turns are in it."""

from __future__ import annotations

from math import floor, frexp, ldexp

from ev_core.elementary.parts import HALF_PI, HALF_PI_TAIL, ROUND, upper_half
from ev_msgs_py.compilable import compilable

UNIT, PER_UNIT = 2.0**24, 2.0**-24


def _digits() -> tuple[float, ...]:
    """2/pi to 1200 bits: digits of 24 bits each from index 2 on, with zeros before the point."""
    bits = int(
        "a2f9836e4e441529fc2757d1f534ddc0db6295993c439041fe5163abdebbc561b7246e3a424dd2e006492eea09d1921cfe1deb1cb129"
        "a73ee88235f52ebb4484e99c7026b45f7e413991d639835339f49c845f8bbdf9283b1ff897ffde05980fef2f118b5a0a6d1f6d367ecf"
        "27cb09b74f463f669e5fea2d7527bac7ebe5f17b3d0739f78a5292ea6bfb5fb11f8d5d0856033046fc7b",
        16,
    )
    return 0.0, 0.0, *(float(bits >> 24 * (49 - i) & 0xFFFFFF) for i in range(50))


TWO_OVER_PI = _digits()

HALF_PI_HIGH = upper_half(HALF_PI)
HALF_PI_LOW = HALF_PI - HALF_PI_HIGH


@compilable
def digit_of_product(x: tuple[float, float, float], at: int, carry: float) -> tuple[float, float]:
    """Return carry, digit: the digit of x times 2/pi at a place, given what the place behind it carries over."""
    total = x[0] * TWO_OVER_PI[at] + x[1] * TWO_OVER_PI[at - 1] + x[2] * TWO_OVER_PI[at - 2] + carry
    over = float(floor(total * PER_UNIT))
    return over, total - over * UNIT


@compilable
def reduced_huge(x: float) -> tuple[int, float, float]:
    """Return n, rest, tail: x = (n + 4 m) pi/2 + rest + tail with |rest| <= pi/4, for finite |x| >= 2**20.

    The digits of x times those of 2/pi that neither give whole turns nor are too small to matter: M. Payne and
    R. Hanek, Radian Reduction for Trigonometric Functions, SIGNUM Newsletter 18, 1983; arranged as in K. C. Ng, Good to
    the Last Bit, 1992. Exact up to the product by pi/2, and no double is so close to a multiple of pi/2 that the digits
    left out show.
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

    # The digits behind, as a sum of two numbers; then all together, with what the sum loses; then times pi/2.
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
    """Both parts of the product of a number in two parts and pi/2 (T. J. Dekker, Numerische Mathematik 18, 1971)."""
    product = rest * HALF_PI
    high = upper_half(rest)
    low = rest - high
    error = ((high * HALF_PI_HIGH - product) + high * HALF_PI_LOW + low * HALF_PI_HIGH) + low * HALF_PI_LOW
    error += rest * HALF_PI_TAIL + tail * HALF_PI
    result = product + error
    return result, (product - result) + error


# Follows fdlibm, whose notice this is:
# Copyright (C) 1993 by Sun Microsystems, Inc. All rights reserved.
# Developed at SunSoft, a Sun Microsystems, Inc. business.
# Permission to use, copy, modify, and distribute this software is freely granted, provided that this notice is
# preserved.

QUARTERS = 0.6366197723675814  # 2 / pi

# pi / 2 in parts of 33 bits, whose multiples are exact up to 2**20, each with all that is missing behind it.
PART_1, BEHIND_1 = 1.57079632673412561417, 6.07710050650619224932e-11
PART_2, PART_3, BEHIND_3 = 6.07710050630396597660e-11, 2.02226624871116645580e-21, 8.47842766036889956997e-32

MODERATE = 2.0**20  # [rad], below 2**20 quarter turns
PLAIN = 1e-8  # a rest above this part of the quarters is not spoilt by cancellation


@compilable
def reduced(x: float) -> tuple[int, float, float]:
    """Return n, rest, tail: x = (n + 4 m) pi/2 + rest + tail with |rest| <= pi/4, for finite x; to 60 bits.

    W. J. Cody and W. Waite, Software Manual for the Elementary Functions, 1980, with the parts of pi/2 that fdlibm's
    e_rem_pio2.c has.
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
    """Count all parts of pi/2, with what each difference loses (D. E. Knuth, TAOCP 2, 4.2.2, theorem B)."""
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
