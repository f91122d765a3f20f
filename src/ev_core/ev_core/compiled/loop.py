"""Compiled code as Python calls it: the instants of a run in one loop, and single functions.

How it works: each part is a C function with its state and its constants, by their addresses. At
each instant those that answer are called one behind the other with the frame of the instant, then
those that integrate, which write into the frame of the next one. The loop ends where a part fails,
or writes a number that is not finite. Where it is on disk it is loaded without numba: importing
numba takes longer than a short run.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from ctypes import CFUNCTYPE, c_int32, c_int64, c_void_p
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from ev_core.compiling.machine_code import Code, call, compiled_function
from ev_core.parameters.record import numbers, record_type
from ev_msgs_py.compilable import compilable
from ev_msgs_py.contract.frame import TIME

FINISHED, NOT_FINITE, FAILED = range(3)

_EXPONENT = 0x7FF0000000000000  # of a float64: all ones in what is infinite or no number
_TEXT = '''"""{function}: generated, do not edit."""

from numba import njit


@njit(error_model="numpy")
def step({arguments}):
    return function({arguments})
'''


class Parts(NamedTuple):
    """Parts of a run, as the loop calls them.

    `rows` has a row of integers for each part: addresses of its function, its state and its
    constants, begin and end of the numbers that it writes. The first `answering` parts answer, the
    others integrate.
    """

    rows: np.ndarray
    answering: int


@compilable
def _is_finite(bits: np.ndarray, at: int, begin: int, end: int) -> bool:
    """Return whether numbers of a frame are finite.

    On integers and without a way out of the loop, so that one instruction looks at many numbers.
    """
    found = 0
    for i in range(begin, end):
        found |= (bits[at, i] & _EXPONENT) == _EXPONENT
    return found == 0


@compilable
def drive_instant(
    frames: np.ndarray,
    here: int,
    there: int,
    which: tuple[int, int],
    parts: Parts,
    stopped: np.ndarray,
) -> int:
    """Let parts answer in frame `here`, or integrate to frame `there`.

    `which` are the first of them, and the first behind them.
    """
    width = frames.shape[1] * 8
    base, bits = frames.ctypes.data, frames.view(np.int64)
    for i in range(which[0], which[1]):
        row = parts.rows[i]
        # A part that answers writes into the frame that it reads.
        at = here if i < parts.answering else there
        status = call(row[0], base + here * width, base + at * width, row[1], row[2])
        # Noted at each part: a look whether it is needed would cost more.
        stopped[0], stopped[1] = at, i
        if status != 0:
            return FAILED
        if not _is_finite(bits, at, row[3], row[4]):
            return NOT_FINITE
    return FINISHED


@compilable
def _drive_instants(
    frames: np.ndarray, first: int, last: int, final: bool, parts: Parts, stopped: np.ndarray
) -> int:
    for n in range(first, last + int(final)):
        # At the last instant of all nothing is left to integrate to.
        end = parts.answering if n == last else len(parts.rows)
        status = drive_instant(frames, n, n + 1, (0, end), parts, stopped)
        if status != FINISHED:
            return status
    return FINISHED


@compilable
def start(frames: np.ndarray, parts: Parts, stopped: np.ndarray) -> int:
    """Let the parts that integrate write their initial outputs into the first frame."""
    for i in range(parts.answering, len(parts.rows)):
        row = parts.rows[i]
        stopped[0], stopped[1], stopped[2] = 0, i, 0
        if call(row[0], 0, frames.ctypes.data, row[1], row[2]) != 0:
            return FAILED
        if not _is_finite(frames.view(np.int64), 0, row[3], row[4]):
            return NOT_FINITE
    return FINISHED


@compilable
def _drive_through(
    frames: np.ndarray, times: np.ndarray, first: int, last: int, parts: Parts, stopped: np.ndarray
) -> int:
    if first == 0:
        status = start(frames, parts, stopped)
        if status != FINISHED:
            return status
    for n in range(first, last + 1):
        here, there = n % 2, (n + 1) % 2
        frames[here, TIME], frames[there, TIME] = times[n], times[min(n + 1, last)]
        # At the instant where the call before has ended all have answered already.
        begin = parts.answering if n == first > 0 else 0
        end = parts.answering if n == last else len(parts.rows)
        status = drive_instant(frames, here, there, (begin, end), parts, stopped)
        if status != FINISHED:
            # The caller needs the instant, and which of the two frames it is in.
            stopped[2] = stopped[0]
            stopped[0] = n if stopped[2] == here else n + 1
            return status
    return FINISHED


_INSTANTS = Code(
    "run_instants",
    '''"""Instants of a run: generated, do not edit."""

import numpy as np
from numba import carray, cfunc, types

I, P = types.int64, types.voidptr


@cfunc(types.int32(P, I, I, I, I, I, P, I, I, P), error_model="numpy")
def step(frames, instants, width, first, last, final, parts, count, answering, stopped):
    return drive(
        carray(frames, (instants, width), np.float64),
        first,
        last,
        final != 0,
        Parts(carray(parts, (count, 5), np.int64), answering),
        carray(stopped, 2, np.int64),
    )
''',
    {"drive": _drive_instants, "Parts": Parts},
)
_THROUGH = Code(
    "run_through",
    '''"""A whole run: generated, do not edit."""

import numpy as np
from numba import carray, cfunc, types

I, P = types.int64, types.voidptr


@cfunc(types.int32(P, I, P, I, I, P, I, I, P), error_model="numpy")
def step(frames, width, times, first, last, parts, count, answering, stopped):
    return drive(
        carray(frames, (2, width), np.float64),
        carray(times, last + 1, np.float64),
        first,
        last,
        Parts(carray(parts, (count, 5), np.int64), answering),
        carray(stopped, 3, np.int64),
    )
''',
    {"drive": _drive_through, "Parts": Parts},
)
# To be compiled before something is driven.
LOOPS = (_INSTANTS, _THROUGH)


@cache
def _instants() -> Any:
    integer, pointer = c_int64, c_void_p
    kinds = pointer, *[integer] * 5, pointer, integer, integer, pointer
    return CFUNCTYPE(c_int32, *kinds)(_INSTANTS.address())


@cache
def _through() -> Any:
    integer, pointer = c_int64, c_void_p
    kinds = pointer, integer, pointer, integer, integer, pointer, integer, integer, pointer
    return CFUNCTYPE(c_int32, *kinds)(_THROUGH.address())


def run_instants(
    frames: np.ndarray, first: int, last: int, final: bool, parts: Parts, stopped: np.ndarray
) -> int:
    """Let the parts answer at the instants first..last-1, and integrate from each to the next.

    `frames` of shape (instants, frame size) begin at the first instant; at a `final` last one all
    answer, too. All arrays are contiguous, those of integers int64. Returns FINISHED; or NOT_FINITE
    or FAILED, with instant and part in `stopped`, and then nothing behind that has been done.
    """
    status: int = _instants()(
        frames.ctypes.data,
        *frames.shape,
        first,
        last,
        final,
        parts.rows.ctypes.data,
        len(parts.rows),
        parts.answering,
        stopped.ctypes.data,
    )
    return status


def run_through(
    frames: np.ndarray, times: np.ndarray, first: int, last: int, parts: Parts, stopped: np.ndarray
) -> int:
    """Drive a run on two frames, in turn that of the instant and the next one.

    All answer at `last`, as `run_instants`. `first` is 0, the start, or the `last` one of the call
    before. `times` are those of the instants from the start on [s]. The third number in `stopped`
    is the index of the frame.
    """
    status: int = _through()(
        frames.ctypes.data,
        frames.shape[1],
        times.ctypes.data,
        first,
        last,
        parts.rows.ctypes.data,
        len(parts.rows),
        parts.answering,
        stopped.ctypes.data,
    )
    return status


def compiled(function: Callable[..., Any]) -> Callable[..., Any]:
    """The function, compiled and kept on disk.

    It takes numbers, arrays, named tuples and what `one_record` makes.
    """
    arguments = ", ".join(inspect.signature(function).parameters)
    text = _TEXT.format(function=function.__qualname__, arguments=arguments)
    step: Callable[..., Any] = compiled_function(function.__name__, text, {"function": function})
    return step


def one_record(values: Any) -> np.ndarray:
    """A record or a tree of numbers as compiled functions take it, in an array of shape (1,)."""
    return np.array(numbers(values)).view(record_type(values))
