"""Random numbers that need no memory: each is a function of a key and a counter, the same in every language.

Philox4x32-10 of J. K. Salmon, M. A. Moraes, R. O. Dror and D. E. Shaw, "Parallel random numbers: as easy as 1, 2, 3",
SC '11 (2011), doi 10.1145/2063384.2063405. Words are of 32 bits. A product of two of them may wrap around in compiled
code, where an integer has 64 bits and a sign, but both its words come out right.
"""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.elementary import log, sin_cos, sqrt

WORD = 0xFFFFFFFF
ROUNDS = 10
M0, M1 = 0xD2511F53, 0xCD9E8D57  # multipliers of a round
W0, W1 = 0x9E3779B9, 0xBB67AE85  # what a round adds to the key: golden ratio and sqrt(3) - 1 in 32 bits
TAU = 6.283185307179586
LAST_BIT = 2.0**-53


@compilable
def philox(c0: int, c1: int, c2: int, c3: int, k0: int, k1: int) -> tuple[int, int, int, int]:
    """Four random words of a counter of four words and a key of two."""
    for _ in range(ROUNDS):
        one, other = M0 * c0, M1 * c2
        c0, c1, c2, c3 = ((other >> 32) & WORD) ^ c1 ^ k0, other & WORD, ((one >> 32) & WORD) ^ c3 ^ k1, one & WORD
        k0, k1 = (k0 + W0) & WORD, (k1 + W1) & WORD
    return c0, c1, c2, c3


@compilable
def uniform(high: int, low: int) -> float:
    """A number 0 <= u < 1 of 53 bits, 27 of one word and 26 of another."""
    return float(((high >> 5) << 26) + (low >> 6)) * LAST_BIT


@compilable
def normals(w0: int, w1: int, w2: int, w3: int) -> tuple[float, float]:
    """Two independent standard normal numbers of four words; G. E. P. Box and M. E. Muller, Ann. Math. Stat. 29 (1958).

    None is larger than sqrt(2 log(2^53)) = 8.6.
    """
    radius = sqrt(-2.0 * log(1.0 - uniform(w0, w1)))
    sine, cosine = sin_cos(TAU * uniform(w2, w3))
    return radius * cosine, radius * sine
