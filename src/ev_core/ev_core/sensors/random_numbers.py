"""Random numbers that need no memory, and one seed for everything random.

How it works: each number is a function of a key and a counter, Philox4x32-10 of J. K. Salmon, M. A.
Moraes, R. O. Dror and D. E. Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC '11 (2011), doi
10.1145/2063384.2063405. The key is a seed and a name, the counter the control period and a purpose:
so a number does not depend on what else is drawn. Words are of 32 bits. A product of two of them
may wrap around in compiled code, where an integer has 64 bits and a sign, but both its words come
out right.
"""

import dataclasses
import zlib
from functools import cache
from typing import Any, TypeVar

from ev_core.elementary import log, sin_cos, sqrt
from ev_core.parameters.declaration import Spec
from ev_core.parameters.values import entries_by_name
from ev_msgs_py.compilable import compilable

WORD = 0xFFFFFFFF
ROUNDS = 10
M0, M1 = 0xD2511F53, 0xCD9E8D57  # multipliers of a round
# what a round adds to the key: golden ratio and sqrt(3) - 1 in 32 bits
W0, W1 = 0x9E3779B9, 0xBB67AE85
TAU = 6.283185307179586
LAST_BIT = 2.0**-53
P = TypeVar("P")
FOR_SEED = 4  # the last word of the counter; sensors and faults have those below
_OWN = "seed"


@compilable
def philox(c0: int, c1: int, c2: int, c3: int, k0: int, k1: int) -> tuple[int, int, int, int]:
    """Four random words of a counter of four words and a key of two."""
    for _ in range(ROUNDS):
        one, other = M0 * c0, M1 * c2
        c0, c1, c2, c3 = (
            ((other >> 32) & WORD) ^ c1 ^ k0,
            other & WORD,
            ((one >> 32) & WORD) ^ c3 ^ k1,
            one & WORD,
        )
        k0, k1 = (k0 + W0) & WORD, (k1 + W1) & WORD
    return c0, c1, c2, c3


@compilable
def uniform(high: int, low: int) -> float:
    """A number 0 <= u < 1 of 53 bits, 27 of one word and 26 of another."""
    return float(((high >> 5) << 26) + (low >> 6)) * LAST_BIT


@compilable
def normals(w0: int, w1: int, w2: int, w3: int) -> tuple[float, float]:
    """Two independent standard normal numbers of four words.

    G. E. P. Box and M. E. Muller, Ann. Math. Stat. 29 (1958). None is larger than sqrt(2 log(2^53))
    = 8.6.
    """
    radius = sqrt(-2.0 * log(1.0 - uniform(w0, w1)))
    sine, cosine = sin_cos(TAU * uniform(w2, w3))
    return radius * cosine, radius * sine


def seeded(parameters: P, seed: int, prefix: str = "") -> P:
    """Parameters for a method, with seeds of its own by that of the node; 0 leaves them alone.

    An own seed is a parameter `seed`
    of a group, such as `road.seed`; its name, its value and the node's seed make the new one,
    within its declared range. A group with a false `is_random` keeps it, and so remains what it is.
    """
    changed: dict[str, Any] = {}
    of: Any = parameters
    kind: type = type(parameters)
    if seed == 0 or not _has_seeds(kind):
        return parameters
    for field in dataclasses.fields(of):
        value = getattr(of, field.name)
        name = prefix + field.name
        if dataclasses.is_dataclass(value):
            made = seeded(value, seed, f"{name}.")
            if made is not value:
                changed[field.name] = made
        elif field.name == _OWN and getattr(of, "is_random", True):
            drawn = philox(value, 0, 0, FOR_SEED, seed, zlib.crc32(name.encode()))[0] >> 1
            changed[_OWN] = _within(entries_by_name(kind)[_OWN].spec, drawn)
    made_anew: P = dataclasses.replace(of, **changed) if changed else parameters
    return made_anew


def _within(spec: Spec, drawn: int) -> int:
    """A number of 31 random bits within the range of a parameter.

    Most ranges hold all 31 bits.
    """
    low = int(spec.low or 0)
    if spec.high is None:
        return low + drawn
    return low + drawn % (int(spec.high) - low + 1)


@cache
def _has_seeds(of: type) -> bool:
    return any(name.rpartition(".")[2] == _OWN for name in entries_by_name(of))
