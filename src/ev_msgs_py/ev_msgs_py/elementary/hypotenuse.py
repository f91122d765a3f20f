"""The length of a vector in the plane."""

from __future__ import annotations

from math import inf, nan, sqrt

from ev_msgs_py.compiling.compilable import compilable

# A shorter side below this part of the longer one is less than half an ulp of the result.
NEGLIGIBLE = 2.0**-54
# Between these the squares, and products of sides with what is left, neither overflow nor lose bits.
SMALL, LARGE = 2.0**-459, 2.0**511
UP, DOWN = 2.0**600, 2.0**-600


@compilable
def hypot(x: float, y: float) -> float:
    """sqrt(x**2 + y**2), the same for (y, x) and for all signs; no overflow on the way; 0.59 ulp.

    The root is corrected by what its square misses, formed without cancellation: C. F. Borges, An Improved Algorithm
    for hypot(a, b), arXiv:1904.09481, 2019, algorithm "unfused corrected".
    """
    a, b = abs(x), abs(y)
    if a < b:
        a, b = b, a
    scale = 1.0
    if not (b >= SMALL and a <= LARGE):
        if a == inf or b == inf:
            return inf
        if not a >= b:
            return nan
        if b <= a * NEGLIGIBLE:
            return a + b
        up, scale = (DOWN, UP) if a > LARGE else (UP, DOWN)
        a *= up
        b *= up
    elif b <= a * NEGLIGIBLE:
        return a + b
    root = sqrt(a * a + b * b)
    if root <= 2.0 * b:
        over = root - b
        missing = a * (2.0 * over - a) + (over - 2.0 * (a - b)) * over
    else:
        over = root - a
        missing = 2.0 * over * (a - 2.0 * b) + ((4.0 * over - b) * b + over * over)
    return (root - missing / (2.0 * root)) * scale
