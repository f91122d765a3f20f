"""Tables of powers of two: 2**(j/32) with more than double precision, and 2**(32 k)."""

from __future__ import annotations

from math import isqrt, ldexp

COUNT = 32
_BITS = 200


def _roots() -> tuple[tuple[float, ...], tuple[float, ...]]:
    """2**(j/32), j = 0..31, as doubles and what these miss: from integers, so without rounding that could differ."""
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

# 2**k is COARSE[(k >> 5) + COARSE_ZERO] * (1 << (k & 31)) for -1022 <= k <= 1023.
COARSE_ZERO = 32
COARSE = tuple(ldexp(1.0, 32 * k) for k in range(-COARSE_ZERO, 32))
