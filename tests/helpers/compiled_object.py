"""A law in its compiled form behind the calls of a class: signals in, signals out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ev_core.compiled.part import CompiledPart
from ev_core.compiling.machine_code import call
from ev_core.methods.method_record import Method
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.fields import shape_of
from ev_msgs_py.contract.signals import Instant


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
        answer = self._answer()
        return answer[0] if len(answer) == 1 else answer

    def advance(self, *signals: Any) -> None:
        """Integrate to the next instant.

        What is not finite is let through to the law, as in plain Python.
        """
        for (place, per_wheel), signal in zip(self._reads, signals, strict=True):
            self._here[place] = sum(signal, ()) if per_wheel else signal
        call(self._function, self._now, self._next, *self._memory)

    def outputs(self) -> tuple[Any, ...]:
        """Everything that it writes, at the instant of its state."""
        call(self._function, 0, self._next, *self._memory)
        return self._answer()

    def reports(self) -> tuple[str, ...]:
        """Notes on the run so far."""
        return self._part.notes()

    @property
    def state(self) -> np.ndarray:
        """All that lasts between steps, the row itself.

        May be set to that of another object of the law.
        """
        return self._part.state

    @state.setter
    def state(self, row: Sequence[float]) -> None:
        self.state[:] = row

    def _answer(self) -> tuple[Any, ...]:
        return tuple(
            [shape.signal_of(self._there[place].tolist()) for place, shape in self._writes]
        )


def _place(kind: type) -> slice:
    return slice(frame.TIME, frame.TIME + 1) if kind is Instant else frame.PLACES[kind]
