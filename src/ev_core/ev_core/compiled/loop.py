"""Compiled code as Python calls it: the instants of a run in one loop, one law as an object, single functions."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
from numba import njit, types

from ev_core.compiled.part import CompiledPart
from ev_core.compiled.part_source import Unpacking, constants_row, constants_type
from ev_core.compiling.machine_code import OPTIONS, call, compiled_function, keep_overloads
from ev_core.methods.law import Given, given_names
from ev_core.methods.register import Method
from ev_core.parameters.record import numbers, record_type
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.fields import shape_of
from ev_msgs_py.contract.frame import SIZE, TIME
from ev_msgs_py.contract.signals import Instant

FINISHED, NOT_FINITE, FAILED = range(3)

_EXPONENT = 0x7FF0000000000000  # of a float64: all ones in what is infinite or no number


@keep_overloads
@njit(nogil=True, **OPTIONS)
def call_part(address: int, now: int, next: int, state: int, constants: int) -> int:
    """Call a part by the addresses of its function, frames, state and constants."""
    return call(address, now, next, state, constants)


@njit(**OPTIONS)
def _is_finite(bits: np.ndarray, at: int, begin: int, end: int) -> bool:
    """Without a way out of the loop, and on integers, so that many numbers are looked at in one instruction."""
    found = 0
    for i in range(begin, end):
        found |= (bits[at, i] & _EXPONENT) == _EXPONENT
    return found == 0


@njit(nogil=True, **OPTIONS)
def _drive_instant(
    frames: np.ndarray, here: int, there: int, is_last: bool, parts: np.ndarray, answering: int, stopped: np.ndarray
) -> int:
    """Let the parts answer in the frame `here` and, unless it is the last one, integrate to that in `there`."""
    width = frames.shape[1] * 8
    base, bits = frames.ctypes.data, frames.view(np.int64)
    for i in range(answering if is_last else parts.shape[0]):
        at = here if i < answering else there
        status = call(parts[i, 0], base + here * width, base + at * width, parts[i, 1], parts[i, 2])
        stopped[0], stopped[1] = at, i
        if status != 0:
            return FAILED
        if not _is_finite(bits, at, parts[i, 3], parts[i, 4]):
            return NOT_FINITE
    return FINISHED


@keep_overloads
@njit(nogil=True, **OPTIONS)
def run_instants(
    frames: np.ndarray, first: int, last: int, final: bool, parts: np.ndarray, answering: int, stopped: np.ndarray
) -> int:
    """Let the parts answer at the instants first..last-1 and integrate from each of them to the next one.

    `frames` of shape (instants, frame size) begin at the first instant; at a `final` last one all answer, too. `parts`
    has a row for each part: addresses of its function, its state and its constants, begin and end of what it writes;
    first those that answer, `answering` of them. Returns FINISHED; or NOT_FINITE or FAILED, with instant and part in
    `stopped`, and then nothing behind that has been done.
    """
    for n in range(first, last + int(final)):
        status = _drive_instant(frames, n, n + 1, n == last, parts, answering, stopped)
        if status != FINISHED:
            return status
    return FINISHED


@keep_overloads
@njit(nogil=True, **OPTIONS)
def run_through(frames: np.ndarray, times: np.ndarray, parts: np.ndarray, answering: int, stopped: np.ndarray) -> int:
    """Drive a whole run from its start on two frames, in turn that of the instant and the next one; as `run_instants`.

    `times` are those of the instants [s]. The third number in `stopped` says which of the frames is meant.
    """
    for i in range(answering, parts.shape[0]):
        stopped[0], stopped[1], stopped[2] = 0, i, 0
        if call(parts[i, 0], 0, frames.ctypes.data, parts[i, 1], parts[i, 2]) != 0:
            return FAILED
        if not _is_finite(frames.view(np.int64), 0, parts[i, 3], parts[i, 4]):
            return NOT_FINITE
    last = len(times) - 1
    for n in range(last + 1):
        here, there = n % 2, (n + 1) % 2
        frames[here, TIME], frames[there, TIME] = times[n], times[min(n + 1, last)]
        status = _drive_instant(frames, here, there, n == last, parts, answering, stopped)
        if status != FINISHED:
            stopped[2] = stopped[0]
            stopped[0] = n if stopped[2] == here else n + 1
            return status
    return FINISHED


def compile_loops() -> None:
    """Make the compiled form of the loops, by runs of no parts."""
    call_part.compile((types.int64,) * 5)
    frames, parts, stopped = np.zeros((2, SIZE)), np.zeros((0, 5), np.int64), np.zeros(3, np.int64)
    run_instants(frames, 0, 1, True, parts, 0, stopped)
    run_through(frames, np.zeros(2), parts, 0, stopped)


class CompiledObject:
    """`step` of a role that answers, `advance` and `outputs` of one that integrates."""

    def __init__(self, method: Method, parameters: Any, vehicle: Any, period: float) -> None:
        self._part = CompiledPart(method, parameters, vehicle, period)
        self._here, self._there = np.zeros(frame.SIZE), np.zeros(frame.SIZE)
        self._function, *self._memory = self._part.addresses()
        self._now, self._next = self._here.ctypes.data, self._there.ctypes.data
        self._reads = [(_place(kind), shape_of(kind).per_wheel) for kind in method.reads]
        self._writes = [(frame.PLACES[kind], shape_of(kind)) for kind in method.writes]

    def step(self, *signals: Any) -> Any:
        """The answer to the signals of an instant."""
        self.advance(*signals)
        said = self._said()
        return said[0] if len(said) == 1 else said

    def advance(self, *signals: Any) -> None:
        """Integrate to the next instant; what is not finite is let through to the law, as in plain Python."""
        for (place, per_wheel), signal in zip(self._reads, signals, strict=True):
            self._here[place] = sum(signal, ()) if per_wheel else signal
        call_part(self._function, self._now, self._next, *self._memory)

    def outputs(self) -> tuple[Any, ...]:
        """Everything that it writes, at the instant of its state."""
        call_part(self._function, 0, self._next, *self._memory)
        return self._said()

    def reports(self) -> tuple[str, ...]:
        """What is worth knowing about the run so far."""
        return self._part.notes()

    @property
    def state(self) -> np.ndarray:
        """All that lasts between steps, the row itself; may be set to that of another object of the law."""
        return self._part.state

    @state.setter
    def state(self, row: Sequence[float]) -> None:
        self.state[:] = row

    def _said(self) -> tuple[Any, ...]:
        return tuple([shape.signal_of(self._there[place].tolist()) for place, shape in self._writes])


def _place(kind: type) -> slice:
    return slice(frame.TIME, frame.TIME + 1) if kind is Instant else frame.PLACES[kind]


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
    """The function, compiled and kept on disk; it takes numbers, arrays, named tuples and what `one_record` makes."""
    arguments = ", ".join(inspect.signature(function).parameters)
    text = _TEXT.format(function=function.__qualname__, arguments=arguments)
    step: Callable[..., Any] = compiled_function(function.__name__, text, {"function": function})
    return step


def one_record(values: Any) -> np.ndarray:
    """A record or a tree of numbers as compiled functions take it, in an array of shape (1,)."""
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
