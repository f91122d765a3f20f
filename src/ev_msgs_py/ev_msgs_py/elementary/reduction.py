"""An angle as a number of quarter turns and a rest of at most an eighth."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.elementary.huge_angles import reduced_huge
from ev_msgs_py.elementary.parts import ROUND

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
