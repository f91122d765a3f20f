"""Single functions that are marked as compilable, called from Python."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from ev_core.compiled.constants import Unpacking, constants_row, constants_type
from ev_core.compiling.machine_code import compiled_function
from ev_core.methods.law import Given, given_names
from ev_core.parameters.record import numbers, record_type

_TEXT = '''"""{function}: generated, do not edit."""

from numba import njit


@njit(error_model="numpy")
def step({arguments}):
    return function({arguments})
'''

_BOUND = '''"""{function}: generated, do not edit."""

from numba import njit


@njit(error_model="numpy")
def step(constants, row, states, {rest}):
    k, s = constants[0], states[0]
    p, car, period = k.p, k.car, k.period
    c = {c}
    return function({given}, {rest})
'''


def compiled(function: Callable[..., Any]) -> Callable[..., Any]:
    """The function, compiled and kept on disk; it takes numbers, arrays, named tuples and `in_memory` records."""
    arguments = ", ".join(inspect.signature(function).parameters)
    text = _TEXT.format(function=function.__qualname__, arguments=arguments)
    step: Callable[..., Any] = compiled_function(function.__name__, text, {"function": function})
    return step


def in_memory(values: Any) -> Any:
    """A record or a tree of numbers as compiled functions take it; its entries are read by name in brackets."""
    return one_record(values)[0]


def one_record(values: Any) -> np.ndarray:
    """The same as an array of shape (1,), which a call finds the type of in a tenth of the time."""
    return np.array(numbers(values)).view(record_type(values))


def bound(function: Callable[..., Any], given: Given) -> Callable[..., Any]:
    """The function, compiled, with what it asks for of p, car, c, s and period; the rest is still to be given."""
    names = given_names(function)
    rest = list(inspect.signature(function).parameters)[len(names) :]
    c, states = given.values["c"], one_record(given.values["s"])
    layout, row = constants_type(given.trees, c), constants_row(given.trees, c, given.values["period"])
    unpacking = Unpacking(c, layout.itemsize // row.itemsize)
    text = _BOUND.format(function=function.__qualname__, given=", ".join(names), rest=", ".join(rest), c=unpacking.text)
    step = compiled_function(function.__name__, text, {"function": function, **unpacking.names})
    return partial(step, row[: layout.itemsize // row.itemsize].view(layout), row, states)
