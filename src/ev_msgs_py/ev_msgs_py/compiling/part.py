"""The object that plays a role in a run, as the compiled loop calls it: a function, a state and constants in memory."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

import numpy as np

from ev_msgs_py.compiling.constants import constants_row
from ev_msgs_py.compiling.library import compiled_part
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.record import fill, numbers
from ev_msgs_py.lockstep.law import Given
from ev_msgs_py.methods import Method
from ev_msgs_py.roles import ROLES, RoleKind
from ev_msgs_py.shape import shape_of
from ev_msgs_py.signals import Instant
from ev_msgs_py.topics import TOPICS

_FUNCTION = ctypes.CFUNCTYPE(ctypes.c_int32, *[ctypes.c_void_p] * 4)
_DOUBLE = ctypes.sizeof(ctypes.c_double)


class CompiledPart:
    """A law whose functions run compiled; `state` is the row of its numbers, advanced in place."""

    def __init__(self, method: Method, parameters: Any, vehicle: Any, period: float) -> None:
        self.given = Given(method.law, parameters, vehicle, period)
        self.function = compiled_part(method, self.given)
        self.constants = constants_row(self.given.trees, self.given.values["c"], period)
        self.state = np.array(numbers(self.given.values["s"]) or [0.0])
        self._notes = method.law.notes

    def addresses(self) -> tuple[int, int, int]:
        """Of the function, the state and the constants."""
        return self.function, self.state.ctypes.data, self.constants.ctypes.data

    def notes(self) -> tuple[str, ...]:
        """What it has to say besides its signals."""
        if self._notes is None:
            return ()
        fill(self.given.values["s"], self.state)
        return self.given.bound(self._notes)()


class PythonPart:
    """An object that runs in plain Python, called from the compiled loop; what it raises waits in `error`."""

    def __init__(self, method: Method, made: Any) -> None:
        self.made = made
        self.error: BaseException | None = None
        self._integrates = ROLES[method.role].kind is RoleKind.INTEGRATES
        self._reads = [_reader(signal) for signal in method.reads]
        self._writes = [_writer(signal) for signal in method.writes]
        self._reports = getattr(made, "reports", None)
        self._function = _FUNCTION(self._step)
        self._address = ctypes.cast(self._function, ctypes.c_void_p).value

    def addresses(self) -> tuple[int, int, int]:
        """Of the function; it needs no other memory."""
        return self._address, 0, 0

    def notes(self) -> tuple[str, ...]:
        """What it has to say besides its signals."""
        return self._reports() if self._reports else ()

    def _step(self, now: int | None, there: int, _state: int | None, _constants: int | None) -> int:
        try:
            if now is not None:
                here = _numbers(now)
                signals = [read(here) for read in self._reads]
                said = self.made.advance(*signals) if self._integrates else (self.made.step(*signals),)
            if self._integrates:
                said = self.made.outputs()
            place = _numbers(there)
            for write, signal in zip(self._writes, said, strict=True):
                write(place, signal)
        except BaseException as error:  # nothing may be raised through compiled code
            self.error = error
            return 1
        return 0


def _numbers(address: int) -> ctypes.Array[ctypes.c_double]:
    return (ctypes.c_double * frame.SIZE).from_address(address)


def _reader(signal: type) -> Callable[[Any], Any]:
    """A function that makes a signal of a frame."""
    if signal is Instant:
        return lambda here: Instant(here[frame.TIME])
    place, shape = frame.PLACES[signal], shape_of(signal)
    return lambda here: shape.signal_of(tuple(here[place]))


def _writer(signal: type) -> Callable[[Any, Any], None]:
    """A function that puts a signal into a frame, as its message carries it."""
    place, codec = frame.PLACES[signal], TOPICS[signal].codec

    def write(there: Any, said: Any) -> None:
        there[place] = tuple(codec.numbers(said))

    return write
