"""Marked functions and laws as compiled code, for tests in which plain Python would take too long."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numba import njit

from ev_msgs_py.compiling.library import OPTIONS, register_functions
from ev_msgs_py.compiling.loop import call_part
from ev_msgs_py.compiling.part import CompiledPart
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.record import names, numbers, record_type
from ev_msgs_py.methods import Method
from ev_msgs_py.shape import shape_of
from ev_msgs_py.wheels import Wheels


def fast(function: Callable[..., Any]) -> Callable[..., Any]:
    """A marked function, compiled; it takes numbers, named tuples and what `in_memory` makes."""
    register_functions()
    return njit(**OPTIONS)(function)


def in_memory(values: Any) -> Any:
    """A record or a tree of numbers as compiled functions take it, to be read by name in brackets."""
    return np.array(numbers(values)).view(record_type(values))[0]


class Compiled:
    """A law that integrates, with signals in and out as its object in plain Python has them."""

    def __init__(self, method: Method, parameters: Any, vehicle: Any, period: float) -> None:
        self.writes = method.writes
        self._reads = method.reads
        self._part = CompiledPart(method, parameters, vehicle, period)
        self._there = np.zeros(frame.SIZE)
        self._call(0)

    def advance(self, *signals: Any) -> None:
        here = np.zeros(frame.SIZE)
        for kind, signal in zip(self._reads, signals, strict=True):
            if kind in frame.PLACES:  # what is not finite is let through
                here[frame.PLACES[kind]] = sum(signal, ()) if type(signal[0]) is Wheels else signal
            else:
                here[frame.TIME] = signal.time
        self._call(here.ctypes.data)

    def outputs(self) -> tuple[Any, ...]:
        return tuple(shape_of(kind).signal_of(tuple(self._there[frame.PLACES[kind]].tolist())) for kind in self.writes)

    def reports(self) -> tuple[str, ...]:
        return self._part.notes()

    @property
    def state(self) -> dict[str, float]:
        """What lasts, by name."""
        return dict(zip(names(self._part.given.values["s"]), self._part.state.tolist(), strict=True))

    def _call(self, now: int) -> None:
        function, state, constants = self._part.addresses()
        call_part(function, now, self._there.ctypes.data, state, constants)
