"""Exact: no function of math or numpy that another C library rounds otherwise (docs/elementary_functions.md)."""

from __future__ import annotations

import dis
import math
from collections.abc import Iterator
from types import FunctionType

import numpy as np

from ev_core.compiling.fingerprint import Reach
from ev_core.methods.register import Method

_OF_BOTH = "sin cos tan sinh cosh tanh exp exp2 expm1 log log2 log10 log1p hypot pow cbrt"
_INVERSE = "sin cos tan tan2 sinh cosh tanh"
_ROUNDED = {
    *_OF_BOTH.split(),
    *(f"a{name}" for name in _INVERSE.split()),
    *(f"arc{name}" for name in _INVERSE.split()),
    *("power", "float_power", "logaddexp", "dist", "erf", "erfc", "gamma", "lgamma"),
}


def inexact(method: Method) -> str:
    """The first function of this kind that a method reaches, and where; empty if there is none."""
    law = method.law
    kinds = getattr(method.factory, "__mro__", ())
    roots = [each for kind in kinds for each in vars(kind).values()] if law is None else [law.function, law.outputs]
    for function in Reach(*(each for each in roots if isinstance(each, FunctionType))).functions.values():
        for line, name in _used(function):
            file = function.__code__.co_filename
            return f"{file}, line {line}: {name} is rounded otherwise elsewhere, take it from ev_core.elementary"
    return ""


def _used(function: FunctionType) -> Iterator[tuple[int, str]]:
    """Line and name of what a function takes from math or numpy and that is in the list."""
    line, module = 0, None
    for each in dis.get_instructions(function):
        line = each.positions.lineno or line if each.positions else line
        if each.opname == "LOAD_GLOBAL":
            found = function.__globals__.get(each.argval)
            module = found if found is math or found is np else None  # an array is equal to nothing as a whole
            own = getattr(found, "__name__", "")
            if own in _ROUNDED and (isinstance(found, np.ufunc) or getattr(found, "__module__", "") == "math"):
                yield line, own
        elif module is not None and each.opname in ("LOAD_ATTR", "LOAD_METHOD") and each.argval in _ROUNDED:
            yield line, f"{module.__name__}.{each.argval}"
