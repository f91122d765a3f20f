"""Measures of the elementary functions: arbitrary precision, and the compiler."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import mpmath
import numba
from hypothesis import strategies as st

from ev_core import elementary
from ev_msgs_py.compilable import FUNCTIONS

# The largest double needs 1024 bits before the point and as many behind it if it is an angle to be
# reduced.
BITS = {"sin": 1300, "cos": 1300, "tan": 1300}

ONE = (
    "sin",
    "cos",
    "tan",
    "asin",
    "acos",
    "atan",
    "exp",
    "expm1",
    "log",
    "log1p",
    "sinh",
    "cosh",
    "tanh",
    "atanh",
)
TWO = ("atan2", "hypot")
ODD = ("sin", "tan", "asin", "atan", "sinh", "tanh", "atanh")
EVEN = ("cos", "cosh")

LIMITS = {
    **dict.fromkeys(("asin", "acos"), (-1.0, 1.0)),
    "atanh": (math.nextafter(-1.0, 0.0), math.nextafter(1.0, 0.0)),
    "log": (5e-324, None),
    "log1p": (math.nextafter(-1.0, 0.0), None),
}


def numbers(name: str) -> st.SearchStrategy[float]:
    """All finite doubles of the domain: some near 1, where cars live, some of any size."""
    low, high = LIMITS.get(name, (None, None))
    middle = st.floats(max(-30.0, low or -30.0), min(30.0, high or 30.0))
    return st.one_of(middle, st.floats(low, high, allow_nan=False, allow_infinity=False))


def error(name: str, *arguments: float) -> float:
    """Distance of our result from the exact one, in units of the last place of the exact one."""
    ours = getattr(elementary, name)(*arguments)
    with mpmath.workprec(BITS.get(name, 150)):
        exact = getattr(mpmath, name)(*map(mpmath.mpf, arguments))
        rounded = float(exact)
        if math.isinf(ours) or math.isinf(rounded):
            return 0.0 if ours == rounded else math.inf
        return float(abs(mpmath.mpf(ours) - exact) / math.ulp(rounded))


def same(a: float, b: float) -> bool:
    """Equal to the bit, but any NaN is like any other."""
    return (a != a and b != b) or (a == b and math.copysign(1.0, a) == math.copysign(1.0, b))


@cache
def compiled(function: Callable[..., Any], arguments: int) -> Callable[..., Any]:
    """A loop over arrays that calls the function, compiled as the laws are."""
    for each in FUNCTIONS:
        if each.__module__.startswith(elementary.__name__):
            register(each)
    register(function)

    if arguments == 1:

        @numba.njit(error_model="numpy")
        def loop(x, out):
            for i in range(x.size):
                out[i] = function(x[i])
    else:

        @numba.njit(error_model="numpy")
        def loop(x, y, out):
            for i in range(x.size):
                out[i] = function(x[i], y[i])

    return loop


@cache
def register(function: Callable[..., Any]) -> None:
    """Make a function known to the compiler, once."""
    numba.extending.register_jitable(error_model="numpy")(function)
