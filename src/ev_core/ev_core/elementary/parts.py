"""Numbers in two parts, for what 53 bits cannot hold.

The module has exact remainders, and the length of a vector in the plane.
"""

from math import copysign, inf, nan, sqrt

from ev_msgs_py.compilable import compilable

# The double nearest to a number, and to what that misses.
PI, PI_TAIL = 3.141592653589793, 1.2246467991473532e-16
HALF_PI, HALF_PI_TAIL = 0.5 * PI, 0.5 * PI_TAIL
QUARTER_PI, QUARTER_PI_TAIL = 0.25 * PI, 0.25 * PI_TAIL

ROUND = 1.5 * 2.0**52  # adding and subtracting it rounds to an integer, half way to the even one
SPLIT = 2.0**27 + 1.0
# A shorter side below this part of the longer one is less than half an ulp of the result.
NEGLIGIBLE = 2.0**-54
# Between these the squares, and products of sides with what is left, neither overflow nor lose
# bits.
SMALL, LARGE = 2.0**-459, 2.0**511
UP, DOWN = 2.0**600, 2.0**-600


@compilable
def upper_half(x: float) -> float:
    """Return the upper 26 bits of x, for |x| < 2**996; products of halves are exact.

    G. W. Veltkamp's, in T. J. Dekker, A Floating-Point Technique for Extending the Available
    Precision, Numerische Mathematik 18, 1971.
    """
    shifted = x * SPLIT
    return shifted - (shifted - x)


@compilable
def hypot(x: float, y: float) -> float:
    """sqrt(x**2 + y**2), the same for (y, x) and for all signs; no overflow on the way; 0.59 ulp.

    The root is corrected by what its square misses, formed without cancellation: C. F. Borges, An
    Improved Algorithm for hypot(a, b), arXiv:1904.09481, 2019, algorithm "unfused corrected".
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


@compilable
def fmod(x: float, y: float) -> float:
    """Remainder x - n y with n the integer part of x/y; exact; NaN for x infinite or y zero.

    To the bit `math.fmod`, which the compiler does not know: between positive numbers % is the
    same.
    """
    size, step = abs(x), abs(y)
    if not (size < inf and step > 0.0):
        return nan
    return copysign(size % step, x)


@compilable
def remainder(x: float, y: float) -> float:
    """Remainder x - n y, n the integer nearest to x/y, the even one of two; exact.

    NaN for x infinite or y zero. To the bit `math.remainder`, which the compiler does not know; by
    the other remainder, as CPython does it.
    """
    size, step = abs(x), abs(y)
    if not (size < inf and step > 0.0):
        return nan
    if step == inf:
        return x
    rest = size % step
    other = step - rest
    if rest > other:
        rest = -other
    elif rest == other:
        # Half way: what x is without this half counts whole steps, an even or an odd number of
        # them.
        rest -= 2.0 * ((0.5 * (size - rest)) % step)
    return copysign(1.0, x) * rest
