"""A shared library of laws: opened, held against the interface, and what it declares."""

from __future__ import annotations

import ctypes
import math
import os
from collections.abc import Iterator
from ctypes import POINTER, Structure, c_char_p, c_double, c_uint32, c_void_p
from dataclasses import make_dataclass
from keyword import iskeyword
from pathlib import Path
from typing import Any

from ev_core.methods.register import refuse_taken
from ev_core.native.interface import BY_WHEEL, CAR, VERSION, bit, layout, reads_of, size_of
from ev_core.parameters.data_file import find_file
from ev_core.parameters.declaration import setting
from ev_msgs_py.contract.roles import ROLES
from ev_msgs_py.refusal import ParameterError, quoted

_WORD = 8  # bytes of a number, and of a pointer
GIVEN = 2 + len(CAR) + 3 * len(BY_WHEEL)  # words of ev_given: period, parameters, car with its wheels
_MOST = 10_000  # parameters or numbers of a state; more is a mistake


_files: dict[Path, list[os.stat_result]] = {}  # those that were opened at a path in this process, one after the other


def path_of(name: str) -> Path:
    """The whole path of the file that a method's name means now."""
    return find_file(name).absolute()


def _opened(path: Path) -> ctypes.CDLL:
    """The file that is there now: the loader gives the one that was there before for the same text of a path.

    OSError if it cannot be loaded, or was written over in place, so that the law that came out of it is damaged.
    """
    before, found = _files.setdefault(path, []), path.stat()
    known = [os.path.samestat(each, found) for each in before]
    place = known.index(True) if True in known else len(before)
    if any(known) and (before[place].st_mtime_ns, before[place].st_size) != (found.st_mtime_ns, found.st_size):
        raise OSError("it was written over while it was in use, allowed is a new file in its place, or a new process")
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
        *((name, c_uint32) for name in ("version", "layout", "inputs_size", "outputs_size", "given_size")),
        ("about", c_char_p),
        ("reads", c_uint32),
        ("number_of_parameters", c_uint32),
        ("parameters", POINTER(_Parameter)),
        ("state_size", c_uint32),
        ("start", c_void_p),
        ("step", c_void_p),
    )


class Library:
    """What a library declares for a role: functions by address, size of the state, parameters as a dataclass.

    ParameterError, in one line that names the file, if it cannot be loaded, has no law for the role, or was made with
    another ev_laws.h.
    """

    def __init__(self, role: str, name: str) -> None:
        self.role, self.name = role, name
        path = path_of(name)
        try:
            self._opened = _opened(path)
        except OSError as error:
            raise self.refused(str(error).rpartition(f"{path.name}: ")[2]) from None
        try:
            declared = _Declared.in_dll(self._opened, f"ev_{role}")
        except ValueError:
            raise self.refused(f"it has no ev_{role}, which a law for this role is declared by (ev_laws.h)") from None
        self._refuse_other_header(declared)
        self.reads = tuple(signal for signal in reads_of(role) if declared.reads & bit(signal))
        self.state_size = declared.state_size
        self.start, self.step = declared.start or 0, declared.step or 0
        if not self.step or not self.reads or max(self.state_size, declared.number_of_parameters) > _MOST:
            raise self.refused("it lacks a step function, reads nothing of its role, or declares absurdly much")
        self.about = _text(declared.about) or "A law in C."
        self.parameters = make_dataclass("LibraryParameters", self._fields(declared), frozen=True, slots=True)
        refuse_taken(f"{role} method {name}", self.parameters)

    def refused(self, why: str) -> ParameterError:
        """The error for something wrong with the library."""
        return ParameterError(f"{self.role} method {self.name}: {why}", "method")

    def _refuse_other_header(self, declared: _Declared) -> None:
        inputs, outputs = 1 + size_of(reads_of(self.role)), size_of(ROLES[self.role].writes)
        here = (VERSION, layout(), inputs * _WORD, outputs * _WORD, GIVEN * _WORD)
        there = tuple(getattr(declared, name) for name in ("version", "layout", "inputs_size", "outputs_size"))
        there += (declared.given_size,)
        for name, one, other in zip(("version", "layout", "inputs", "outputs", "given"), there, here, strict=True):
            if one != other:
                shown = f"{one:#010x}, here it is {other:#010x}" if name == "layout" else f"{one}, here it is {other}"
                raise self.refused(f"compiled with another ev_laws.h: {name} {shown}; make it anew with that of here")

    def _fields(self, declared: _Declared) -> Iterator[tuple[str, type, Any]]:
        seen: set[str] = set()
        for each in declared.parameters[: declared.number_of_parameters]:
            name, low, high = _text(each.name), each.low, each.high
            if name in seen or iskeyword(name) or name.startswith("_"):
                allowed = "allowed is once" if name in seen else "allowed is a name of Python's without _ before it"
                raise self.refused(f"parameter {quoted(name)} is refused, {allowed}")
            seen.add(name)
            if not name.isidentifier() or not low <= each.value <= high or not math.isfinite(each.value):
                raise self.refused(f"parameter {quoted(name)} needs a name and a finite value between its bounds")
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
