"""A law of a shared library as a method, `asr=build/liblimit.so`.

How it works: the library is opened and held against the interface, and what it declares becomes
parameters of the method. One row of numbers has inputs, outputs, and what the functions are given,
each as the structs of ev_laws.h have them. Plain Python fills the row and calls the C function;
compiled code does the same by an adapter, without Python.
"""

from __future__ import annotations

import ctypes
import math
import os
from collections.abc import Iterator, Sequence
from ctypes import POINTER, Structure, c_char_p, c_double, c_uint32, c_void_p
from dataclasses import make_dataclass
from functools import cache
from keyword import iskeyword
from pathlib import Path
from typing import Any

import numpy as np

from ev_core.compiling.machine_code import FUNCTION
from ev_core.methods.common_parameters import refuse_taken
from ev_core.methods.method_record import Method
from ev_core.methods.part import PythonPart
from ev_core.native.adapter import INPUTS, STATUS, adapter
from ev_core.native.interface import (
    BY_WHEEL,
    CAR,
    LAW_ROLES,
    VERSION,
    bit,
    car_row,
    layout,
    reads_of,
    size_of,
)
from ev_core.parameters.data_file import find_file
from ev_core.parameters.declaration import number_tree, setting
from ev_core.vehicle.car import car_numbers
from ev_msgs_py.contract.fields import SignalError, shape_of
from ev_msgs_py.contract.roles import ROLES
from ev_msgs_py.contract.signals import Instant
from ev_msgs_py.refusal import ParameterError, quoted

_WORD = 8  # bytes of a number, and of a pointer
# words of ev_given: period, parameters, car with its wheels
GIVEN = 2 + len(CAR) + 3 * len(BY_WHEEL)
_MOST = 10_000  # parameters or numbers of a state; more is a mistake


# those that were opened at a path in this process, one after the other
_files: dict[Path, list[os.stat_result]] = {}


def _opened(path: Path) -> ctypes.CDLL:
    """The file that is there now.

    The loader gives the one that was there before for the same text of a path. OSError if it cannot
    be loaded, or was written over in place, so that the law that came out of it is damaged.
    """
    before = _files.setdefault(path, [])
    found = path.stat()
    known = [os.path.samestat(each, found) for each in before]
    place = known.index(True) if True in known else len(before)
    if any(known):
        then = before[place]
        if (then.st_mtime_ns, then.st_size) != (found.st_mtime_ns, found.st_size):
            raise OSError(
                "it was written over while it was in use, "
                "expected a new file in its place, or a new process"
            )
    # Each file that was there gets another text of the path, so that the loader looks again.
    opened = ctypes.CDLL(f"{path.parent}{'/.' * place}/{path.name}")
    if not any(known):
        before.append(found)
    return opened


class _Parameter(Structure):
    _fields_ = (
        *((name, c_char_p) for name in ("name", "unit", "about")),
        *((name, c_double) for name in ("value", "low", "high")),
    )


class _Declared(Structure):
    """ev_asr_law and its like."""

    _fields_ = (
        *(
            (name, c_uint32)
            for name in ("version", "layout", "inputs_size", "outputs_size", "given_size")
        ),
        ("about", c_char_p),
        ("reads", c_uint32),
        ("number_of_parameters", c_uint32),
        ("parameters", POINTER(_Parameter)),
        ("state_size", c_uint32),
        ("start", c_void_p),
        ("step", c_void_p),
    )


class Library:
    """Declaration of a library for a role, which makes objects of its law.

    `start` and `step` are addresses, `state_size` is in numbers, `parameters` is a dataclass of
    what it declares. ParameterError, in one line that names the file, if it cannot be loaded, has
    no law for the role, or was made with another ev_laws.h.
    """

    def __init__(self, role: str, name: str, path: Path) -> None:
        self.role, self.name = role, name
        try:
            self._opened = _opened(path)
        except OSError as error:
            raise self.refused(str(error).rpartition(f"{path.name}: ")[2]) from None
        try:
            declared = _Declared.in_dll(self._opened, f"ev_{role}")
        except ValueError:
            raise self.refused(
                f"it has no ev_{role}, which a law for this role is declared by (ev_laws.h)"
            ) from None
        self._refuse_other_header(declared)
        self.reads = tuple(signal for signal in reads_of(role) if declared.reads & bit(signal))
        self.state_size = declared.state_size
        self.start = declared.start or 0
        self.step = declared.step or 0
        declares_too_much = max(self.state_size, declared.number_of_parameters) > _MOST
        if not self.step or not self.reads or declares_too_much:
            raise self.refused(
                "it lacks a step function, reads nothing of its role, or declares absurdly much"
            )
        if declared.number_of_parameters and not declared.parameters:
            raise self.refused("it lacks the table of parameters that it declares")
        self.__doc__ = _text(declared.about) or "A law in C."
        self.parameters = make_dataclass(
            "LibraryParameters", self._fields(declared), frozen=True, slots=True
        )
        refuse_taken(f"{role} method {name}", self.parameters)

    def __call__(self, parameters: Any, vehicle: Any, period: float) -> NativeLaw:
        """A new object, at rest."""
        return NativeLaw(self, parameters, car_row(car_numbers(vehicle)), period)

    def part(self, method: Method, made: NativeLaw) -> NativePart:
        """The part that plays a role by such an object."""
        return NativePart(method, made)

    def refused(self, why: str) -> ParameterError:
        """The error for something wrong with the library."""
        return ParameterError(f"{self.role} method {self.name}: {why}", "method")

    def _refuse_other_header(self, declared: _Declared) -> None:
        expected = {
            "version": VERSION,
            "layout": layout(),
            "inputs_size": _WORD * (1 + size_of(reads_of(self.role))),
            "outputs_size": _WORD * size_of(ROLES[self.role].writes),
            "given_size": _WORD * GIVEN,
        }
        for name, here in expected.items():
            found = getattr(declared, name)
            if found != here:
                # The layout is a check number, which means nothing as a decimal.
                form = "#010x" if name == "layout" else "d"
                what = f"{name.removesuffix('_size')} {found:{form}}, here it is {here:{form}}"
                raise self.refused(
                    f"compiled with another ev_laws.h: {what}; compile it again with that of here"
                )

    def _fields(self, declared: _Declared) -> Iterator[tuple[str, type, Any]]:
        seen: set[str] = set()
        for each in declared.parameters[: declared.number_of_parameters]:
            name = _text(each.name)
            low = each.low
            high = each.high
            if name in seen:
                raise self.refused(f"parameter {quoted(name)} is refused, expected once")
            if iskeyword(name) or name.startswith("_"):
                expected = "a name of Python's without _ before it"
                raise self.refused(f"parameter {quoted(name)} is refused, expected {expected}")
            seen.add(name)
            is_within = low <= each.value <= high and math.isfinite(each.value)
            if not name.isidentifier() or not is_within:
                raise self.refused(
                    f"parameter {quoted(name)} needs a name and a finite value between its bounds"
                )
            declared_as = setting(
                each.value,
                about=_text(each.about),
                unit=_text(each.unit),
                low=low if low > -math.inf else None,
                high=high if high < math.inf else None,
            )
            yield name, float, declared_as


def _text(raw: bytes | None) -> str:
    return (raw or b"").decode("utf-8", "replace")


def library_method(role: str, name: str) -> Method:
    """The method of a role that a library brings; ParameterError, in one line, if it cannot."""
    if role not in LAW_ROLES:
        raise ParameterError(
            f"{role} method {name}: a library plays one of {', '.join(LAW_ROLES)}", "method"
        )
    path = find_file(name).absolute()
    try:
        found = path.stat()
    except OSError as error:
        raise ParameterError(f"{role} method {name}: {error.strerror}", "method") from None
    return _made(role, name, path, (found.st_dev, found.st_ino, found.st_mtime_ns, found.st_size))


@cache
def _made(role: str, name: str, path: Path, _file: tuple[int, ...]) -> Method:
    """The same for one file, as it was built once."""
    library = Library(role, name, path)
    return Method(role, name, library, (Instant, *library.reads), library.parameters)


class NativeLaw:
    """One object of a law.

    It has a state, and in one row what the functions are given, as in ev_laws.h.
    """

    def __init__(
        self, library: Library, parameters: Any, car: Sequence[float], period: float
    ) -> None:
        role = library.role
        self.library = library
        self.places: dict[type, int] = {Instant: INPUTS}
        place = INPUTS + 1
        for signal in reads_of(role):
            self.places[signal] = place
            place += size_of((signal,))
        (self._written,) = ROLES[role].writes
        self.outputs = place
        self.given = self.outputs + size_of((self._written,))
        values = list(number_tree(parameters).values())
        self.row = np.array([*[0.0] * self.given, period, 0.0, *car, *values])
        # Two words are addresses: of the function, and of the parameters behind the car.
        words = self.row.view(np.int64)
        words[0] = library.step
        words[self.given + 1] = self.address(self.given + GIVEN)
        self.memory = np.zeros(max(library.state_size, 1))
        self._step = FUNCTION(library.step)
        if library.start:
            start = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p)(library.start)
            start(self.memory.ctypes.data, self.address(self.given))

    def address(self, place: int) -> int:
        """Address of a number of the row."""
        return self.row.ctypes.data + 8 * place

    def step(self, instant: Instant, *signals: Any) -> Any:
        """The answer to the signals that the law reads.

        SignalError if the function returns anything else than 0.
        """
        self.row[INPUTS] = instant.time
        for kind, signal in zip(self.library.reads, signals, strict=True):
            shape = shape_of(kind)
            self.row[self.places[kind] : self.places[kind] + shape.size] = shape.flat(signal)
        addresses = (self.address(INPUTS), self.address(self.outputs), self.memory.ctypes.data)
        self.row[STATUS] = self._step(*addresses, self.address(self.given))
        if self.row[STATUS]:
            raise self.error
        return shape_of(self._written).signal_of(self.row[self.outputs : self.given].tolist())

    @property
    def error(self) -> SignalError:
        """Error of a function that has not returned 0, or of its answer."""
        # Without a status of its own it is the answer: a number is negative that must not be.
        if not self.row[STATUS]:
            shape = shape_of(self._written)
            answer = self.row[self.outputs : self.given].tolist()
            return shape.negative(answer, shape.never_negative)
        return SignalError(f"{self.library.name}: step returned {self.row[STATUS]:g}, expected 0")

    @property
    def state(self) -> list[float]:
        """All that lasts between steps; may be set to that of another object."""
        numbers: list[float] = self.memory[: self.library.state_size].tolist()
        return numbers

    @state.setter
    def state(self, row: Sequence[float]) -> None:
        self.memory[: self.library.state_size] = row


class NativePart(PythonPart):
    """Plays a role by a law of a library; the compiled loop calls it without Python in between."""

    @property
    def error(self) -> BaseException | None:
        """Error that the compiled loop raises where a step failed."""
        error: SignalError = self.made.error
        return error

    @error.setter
    def error(self, error: BaseException | None) -> None:
        """Do nothing: the error follows from what the function returned."""

    def addresses(self) -> tuple[int, int, int]:
        """Addresses of the compiled step between frame and library, of state and row."""
        law: NativeLaw = self.made
        places = tuple(law.places.items())
        address = adapter(law.library.role, law.library.reads, places, law.outputs, law.given)
        return address, law.memory.ctypes.data, law.address(0)
