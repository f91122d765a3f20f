"""Angles of 2**20 radians and more, without the turns that are in them."""

from __future__ import annotations

from math import floor, frexp, ldexp

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.elementary.parts import HALF_PI, HALF_PI_TAIL, upper_half

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
