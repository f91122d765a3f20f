"""Numbers in two parts, for what 53 bits cannot hold."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import compilable

# The double nearest to a number, and to what that misses.
PI, PI_TAIL = 3.141592653589793, 1.2246467991473532e-16
HALF_PI, HALF_PI_TAIL = 0.5 * PI, 0.5 * PI_TAIL
QUARTER_PI, QUARTER_PI_TAIL = 0.25 * PI, 0.25 * PI_TAIL

ROUND = 1.5 * 2.0**52  # adding and subtracting it rounds to an integer, half way to the even one
SPLIT = 2.0**27 + 1.0


@compilable
def upper_half(x: float) -> float:
    """Return the upper 26 bits of x, for |x| < 2**996; products of halves are exact.

    G. W. Veltkamp's, in T. J. Dekker, A Floating-Point Technique for Extending the Available Precision, Numerische
    Mathematik 18, 1971.
    """
    shifted = x * SPLIT
    return shifted - (shifted - x)
