"""The object that plays a role.

It reads signals in one frame and writes its own into the same or the next one. There is one kind of
step for all ways of running: offline, in one process, as processes, in lockstep, in real time.
"""

import ctypes
import math
from array import array
from collections.abc import Callable
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from ev_core.compiling.machine_code import FUNCTION
from ev_core.methods.hooks import Reporting
from ev_core.methods.law_error import (
    BY_AUTHORS,
    WrongResultError,
    in_law,
    notes_of,
    raise_in_one_line,
)
from ev_core.methods.method_record import Method
from ev_msgs_py.compilable import compilable
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.fields import NEGLIGIBLE, Shape, shape_of
from ev_msgs_py.contract.frame import TIME, Frame
from ev_msgs_py.contract.roles import ROLES, RoleKind
from ev_msgs_py.contract.signals import Instant
from ev_msgs_py.contract.wheels import WHEEL_NAMES


@compilable
def without_sign(value: float) -> float:
    """A number that is never negative.

    0 for one that is so by rounding alone, NaN for one that is.
    """
    if value >= 0.0:
        return value
    return 0.0 if value >= -NEGLIGIBLE else math.nan


class Part(Protocol):
    """Interface of a part for a run."""

    state: Any
    """All that lasts between steps; may be set to that of another part of the same method."""

    def start(self, there: Frame) -> None:
        """Write the initial outputs of a role that integrates.

        SignalError if a number is not finite.
        """

    def step(self, here: Frame, there: Frame) -> None:
        """Answer in the frame `there` to the signals in `here`, or integrate to it.

        SignalError as above.
        """

    def refuse_not_finite(self, there: Frame) -> None:
        """Refuse a number that is not finite (SignalError).

        The part wrote it, or a sensor or fault did.
        """

    def notes(self) -> tuple[str, ...]:
        """All that is worth knowing about the run so far, besides the signals."""

    def addresses(self) -> tuple[int, int, int]:
        """Addresses of C function, state and constants, by which compiled code steps it."""


class CalledBack:
    """A part that is stepped in Python: compiled code calls it back.

    An exception is kept in `error`.
    """

    error: BaseException | None = None

    def addresses(self) -> tuple[int, int, int]:
        """Address of the function that compiled code calls.

        It needs no memory for state and constants.
        """
        return ctypes.cast(self._function, ctypes.c_void_p).value or 0, 0, 0

    @cached_property
    def _function(self) -> Any:
        return FUNCTION(self._called_back)

    def _called_back(
        self: Any, here: int | None, there: int, _state: int | None, _constants: int | None
    ) -> int:
        try:
            if here is None:
                self.start(Frame.at(there))
            else:
                self.step(Frame.at(here), Frame.at(there))
        except BaseException as error:  # nothing may be raised through compiled code
            self.error = error
            return 1
        return 0


class PythonPart(CalledBack):
    """An object with steps in plain Python."""

    def __init__(self, method: Method, made: Any, note: str = "") -> None:
        self.made = made
        self._method = method
        self._note = (note,) if note else ()
        self._reads = tuple(_reader(signal) for signal in method.reads)
        self._writes = tuple(_writer(signal) for signal in method.writes)
        self._answers = ROLES[method.role].kind is RoleKind.ANSWERS
        self._single = self._answers and len(self._writes) == 1
        self._outputs = method.law.outputs if method.law else getattr(made, "outputs", None)
        self._shapes = tuple((shape_of(signal), frame.PLACES[signal]) for signal in method.writes)
        self._reports = made.reports if isinstance(made, Reporting) else None

    @property
    def state(self) -> Any:
        """The state of the object."""
        with in_law(self._method):
            return self.made.state

    @state.setter
    def state(self, state: Any) -> None:
        with in_law(self._method):
            self.made.state = state

    def start(self, there: Frame) -> None:
        """Write the initial outputs."""
        with in_law(self._method):
            self._write(self.made.outputs(), there.numbers, self._outputs)

    def step(self, here: Frame, there: Frame) -> None:
        """One step of the object."""
        signals = [read(here.numbers) for read in self._reads]
        # Without `in_law`, which takes longer than many a law.
        try:
            if self._answers:
                self._write(self.made.step(*signals), there.numbers, self.made.step)
            else:
                self.made.advance(*signals)
                self._write(self.made.outputs(), there.numbers, self._outputs)
        except BY_AUTHORS as error:
            raise_in_one_line(self._method, error, here.numbers[TIME])

    def _write(self, output: Any, there: Any, by: Any) -> None:
        """Put what a function gives into the frame.

        WrongResultError unless it has the shape of what is written.
        """
        # A tuple is one answer of several signals; a NamedTuple is a single signal.
        if self._single:
            output = (output,)
        elif type(output) is not tuple or len(output) != len(self._writes):
            names = ", ".join(shape.signal.__name__ for shape, _ in self._shapes)
            raise WrongResultError(by, output, f"a tuple of {names}")
        for write, signal, (shape, _) in zip(self._writes, output, self._shapes, strict=True):
            if type(signal) is not shape.signal:
                expected = shape.signal.__name__
                raise WrongResultError(by, signal, f"{expected}: return {expected}(...)")
            try:
                write(there, signal)
            except TypeError as error:
                raise WrongResultError(by, *_wrong_field(shape, signal)) from error

    def refuse_not_finite(self, there: Frame) -> None:
        """SignalError if a number that it wrote is not finite."""
        for shape, place in self._shapes:
            values = there.numbers[place]
            if not math.isfinite(sum(values)):
                shape.refuse_not_finite(values)

    def notes(self) -> tuple[str, ...]:
        """Reports of the object, behind the note of its maker."""
        if self._reports is None:
            return self._note
        with in_law(self._method):
            return (*self._note, *notes_of(self._reports))


def _reader(signal: type) -> Callable[[Any], Any]:
    """A function that makes a signal of the bytes of a frame."""
    if signal is Instant:
        return lambda here: Instant(frame.time_in(here))
    return shape_of(signal).reader(frame.PLACES[signal].start)


def _writer(signal: type) -> Callable[[Any, Any], None]:
    """A function that puts a signal into the numbers of a frame, as its message carries it."""
    place = frame.PLACES[signal]
    shape = shape_of(signal)
    # Looked up once: the function below is called in every step.
    per_wheel = shape.per_wheel
    has_single = shape.has_single
    never_negative = shape.never_negative

    def write(there: Any, output: Any) -> None:
        values = output
        if per_wheel:
            for each in output:
                if len(each) != len(WHEEL_NAMES):
                    raise TypeError("no Wheels")
            values = sum(output, ())
        if never_negative:
            values = shape.without_sign(values, never_negative)
        if has_single:
            values = shape.carried(values)
        if not math.isfinite(sum(values)):
            shape.refuse_not_finite(shape.flat(output))
        there[place] = array("d", values)

    return write


def _wrong_field(shape: Shape, signal: Any) -> tuple[Any, str]:
    """The first field of a signal that is no number or not one for each wheel.

    With it comes what is expected there.
    """
    for name, value in zip(signal._fields, signal, strict=True):
        where = f"as {name} of its {shape.signal.__name__}"
        if shape.per_wheel and (not isinstance(value, tuple) or len(value) != len(WHEEL_NAMES)):
            return value, f"Wheels(a, b, c, d) {where}"
        for number in value if shape.per_wheel else (value,):
            if not isinstance(number, (int, float, np.number)):
                return number, f"a number {where}"
    return signal, f"numbers in its {shape.signal.__name__}"
