"""A law of a shared library as a method: `asr=build/liblimit.so`, in plain Python and in the compiled loop."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from ev_core.compiling.machine_code import FUNCTION, call, function_address
from ev_core.methods.part import PythonPart
from ev_core.methods.register import Method
from ev_core.native.interface import LAW_ROLES, car_row, reads_of, size_of
from ev_core.native.library import GIVEN, Library, path_of
from ev_core.parameters.declaration import number_tree
from ev_core.vehicle.car import car_numbers
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.fields import SignalError, shape_of
from ev_msgs_py.contract.roles import ROLES
from ev_msgs_py.contract.signals import Instant
from ev_msgs_py.refusal import ParameterError

STATUS = 1  # place of what the last step returned; before it stands the address of the function, behind it the inputs
INPUTS = 2


def library_method(role: str, name: str) -> Method:
    """The method of a role that a library brings; ParameterError, in one line, if it cannot."""
    if role not in LAW_ROLES:
        raise ParameterError(f"{role} method {name}: a library plays one of {', '.join(LAW_ROLES)}", "method")
    path = path_of(name)
    try:
        found = path.stat()
    except OSError as error:
        raise ParameterError(f"{role} method {name}: {error.strerror}", "method") from None
    return _made(role, name, path, (found.st_dev, found.st_ino, found.st_mtime_ns, found.st_size))


@cache
def _made(role: str, name: str, _path: Path, _file: tuple[int, ...]) -> Method:
    """The same for one file, as it was built once."""
    factory = NativeMethod(Library(role, name))
    return Method(role, name, factory, (Instant, *factory.library.reads), factory.parameters)


class NativeMethod:
    """Makes the objects of a law in a library."""

    def __init__(self, library: Library) -> None:
        self.library, self.parameters, self.__doc__ = library, library.parameters, library.about

    def __call__(self, parameters: Any, vehicle: Any, period: float) -> NativeLaw:
        """A new object, at rest."""
        return NativeLaw(self.library, parameters, car_row(car_numbers(vehicle)), period)

    def part(self, method: Method, made: NativeLaw) -> NativePart:
        """What plays a role by such an object."""
        return NativePart(method, made)


class NativeLaw:
    """One object of a law: its state, and in one row what the functions are given, as ev_laws.h has it."""

    def __init__(self, library: Library, parameters: Any, car: Sequence[float], period: float) -> None:
        role = library.role
        self.library = library
        self.places: dict[type, int] = {Instant: INPUTS}
        place = INPUTS + 1
        for signal in reads_of(role):
            self.places[signal] = place
            place += size_of((signal,))
        (self._said,) = ROLES[role].writes
        self.outputs = place
        self.given = self.outputs + size_of((self._said,))
        values = list(number_tree(parameters).values())
        self.row = np.array([*[0.0] * self.given, period, 0.0, *car, *values])
        words = self.row.view(np.int64)
        words[0] = library.step
        words[self.given + 1] = self.address(self.given + GIVEN)
        self._memory = np.zeros(max(library.state_size, 1))
        self._step = FUNCTION(library.step)
        if library.start:
            start = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p)(library.start)
            start(self._memory.ctypes.data, self.address(self.given))

    def address(self, place: int) -> int:
        """Of a number of the row."""
        return self.row.ctypes.data + 8 * place

    def step(self, instant: Instant, *signals: Any) -> Any:
        """The answer to the signals that the law reads; SignalError if the function returns anything else than 0."""
        self.row[INPUTS] = instant.time
        for kind, signal in zip(self.library.reads, signals, strict=True):
            shape = shape_of(kind)
            self.row[self.places[kind] : self.places[kind] + shape.size] = shape.flat(signal)
        addresses = (self.address(INPUTS), self.address(self.outputs), self._memory.ctypes.data)
        self.row[STATUS] = self._step(*addresses, self.address(self.given))
        if self.row[STATUS]:
            raise self.error
        return shape_of(self._said).signal_of(self.row[self.outputs : self.given].tolist())

    @property
    def error(self) -> SignalError:
        """What to say of a function that has not returned 0."""
        return SignalError(f"{self.library.name}: step returned {self.row[STATUS]:g}, allowed is 0")

    @property
    def state(self) -> list[float]:
        """All that lasts between steps; may be set to that of another object."""
        numbers: list[float] = self._memory[: self.library.state_size].tolist()
        return numbers

    @state.setter
    def state(self, row: Sequence[float]) -> None:
        self._memory[: self.library.state_size] = row

    @property
    def memory(self) -> int:
        """The address of the state."""
        return self._memory.ctypes.data


class NativePart(PythonPart):
    """Plays a role by a law of a library; the compiled loop calls it without Python in between."""

    def __init__(self, method: Method, made: NativeLaw) -> None:
        super().__init__(method, made)
        self._law = made

    @property
    def error(self) -> BaseException | None:
        """What the compiled loop raises where a step failed."""
        return self._law.error

    @error.setter
    def error(self, error: BaseException | None) -> None:
        """It follows from what the function returned."""

    def addresses(self) -> tuple[int, int, int]:
        """Of the compiled step between frame and library, of state and row."""
        return adapter_address(self._law), self._law.memory, self._law.address(0)


_TEXT = '''"""{role} in a library: generated, do not edit."""

from numba import carray, cfunc, types

P = types.voidptr


@cfunc(types.int32(P, P, P, P), error_model="numpy")
def step(now, next, state, constants):
    here, there = carray(now, {size}, FLOAT), carray(next, {size}, FLOAT)
    row, words, memory = carray(constants, {row}, FLOAT), carray(constants, 1, INT), carray(state, 1, FLOAT)
{copying}
    at = row.ctypes.data
    status = call(words[0], at + {inputs}, at + {outputs}, memory.ctypes.data, at + {given})
    row[{status}] = status
{writing}
    return status
'''


def adapter_address(law: NativeLaw) -> int:
    """Of the compiled step of a law, which is the same for all laws of a role that read the same signals."""
    return _compiled(law.library.role, law.library.reads, tuple(law.places.items()), law.outputs, law.given)


@cache
def _compiled(
    role: str, reads: tuple[type, ...], places: tuple[tuple[type, int], ...], outputs: int, given: int
) -> int:
    row = dict(places)
    (said,) = ROLES[role].writes
    copying = [f"row[{row[Instant]}] = here[{frame.TIME}]"]
    for signal in reads:
        copying += [f"row[{row[signal] + i}] = here[{at}]" for i, at in enumerate(frame.places(signal))]
    writing = [f"there[{at}] = row[{outputs + i}]" for i, at in enumerate(frame.places(said))]
    copying, writing = ([f"    {line}" for line in lines] for lines in (copying, writing))
    text = _TEXT.format(
        role=role,
        size=frame.SIZE,
        row=given,
        copying="\n".join(copying),
        writing="\n".join(writing),
        inputs=8 * INPUTS,
        outputs=8 * outputs,
        given=8 * given,
        status=STATUS,
    )
    return function_address(f"library_{role}", text, {"FLOAT": np.float64, "INT": np.int64, "call": call})
