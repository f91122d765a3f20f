"""Single functions that are marked as compilable, called from Python."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from ev_msgs_py.compiling.library import compiled_function
from ev_msgs_py.contract.record import numbers, record_type

_TEXT = '''"""{function}: generated, do not edit."""

from numba import njit


@njit(cache=True, error_model="numpy")
def step({arguments}):
    return function({arguments})
'''


@cache
def compiled(function: Callable[..., Any]) -> Callable[..., Any]:
    """The function, compiled and kept on disk; it takes numbers, arrays, named tuples and `in_memory` records."""
    arguments = ", ".join(inspect.signature(function).parameters)
    text = _TEXT.format(function=function.__qualname__, arguments=arguments)
    return compiled_function(function.__name__, text, {"function": function})


def in_memory(values: Any) -> Any:
    """A record or a tree of numbers as compiled functions take it; its entries are read by name in brackets."""
    return np.array(numbers(values)).view(record_type(values))[0]
