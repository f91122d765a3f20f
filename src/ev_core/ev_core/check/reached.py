"""Lines that the checks reach in a law's text, and functions that C libraries round differently.

A line that no input reaches is unchecked: a law that works only while the pedal is free would pass
all checks with the brakes pressed. A function of math or numpy is exact if every C library rounds
it in the same way (docs/elementary_functions.md).
"""

import dis
import math
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from types import CodeType, FunctionType
from typing import Any

import numpy as np

from ev_core.check.stepping import Subject, outputs
from ev_core.compiling.fingerprint import Reach
from ev_core.methods.method_record import Method

_BESIDES = ("reports", "state")  # hooks that a run may never call
_Line = tuple[CodeType, int]
# Functions of math and numpy that C libraries round differently.
_OF_BOTH = "sin cos tan sinh cosh tanh exp exp2 expm1 log log2 log10 log1p hypot pow cbrt"
_INVERSE = "sin cos tan tan2 sinh cosh tanh"
_ROUNDED = {
    *_OF_BOTH.split(),
    *(f"a{name}" for name in _INVERSE.split()),
    *(f"arc{name}" for name in _INVERSE.split()),
    *("power", "float_power", "logaddexp", "dist", "erf", "erfc", "gamma", "lgamma"),
}


@dataclass(frozen=True)
class Reached:
    """Counts of calls of the functions in a law's own module, and of each line.

    Both are empty where plain Python was not stepped, or a debugger is at work.
    """

    calls: dict[str, int]
    lines: dict[tuple[str, int], int]

    @property
    def never_called(self) -> tuple[str, ...]:
        """The functions that no input has reached."""
        return tuple(name for name, count in self.calls.items() if not count)

    def __str__(self) -> str:
        """A line for each function, and for each file its rarest lines."""
        called = [f"{name}: called {count} times" for name, count in self.calls.items()]
        return "\n".join((*called, *self._seldom()))

    def _seldom(self) -> Iterator[str]:
        for file, of_file in groupby(sorted(self.lines), key=lambda place: place[0]):
            counts = {line: self.lines[file, line] for _, line in of_file}
            never = [line for line, count in counts.items() if not count]
            rarest = sorted((count, line) for line, count in counts.items() if count)[:3]
            shown = ", ".join(f"line {line} {count} times" for count, line in rarest)
            missed = f"; never {', '.join(map(str, never))}" if never else ""
            yield f"{file}: {len(counts) - len(never)} of {len(counts)} lines, {shown}{missed}"


def reached(subject: Subject, seeds: Sequence[int]) -> Reached:
    """Step a method with all these seeds, and count the lines of it that they reach."""
    # A debugger or a measurement of coverage traces already, and Python has one trace alone.
    if subject.compiled or sys.gettrace() is not None:
        return Reached({}, {})
    functions = _functions(subject.configuration.method)
    codes = {function.__code__: _named(function) for function in functions}
    calls = dict.fromkeys(codes.values(), 0)
    lines = Counter[_Line]()
    with _counting(codes, calls, lines):
        for seed in seeds:
            outputs(subject.part(), subject.frames(seed))
    counts: dict[tuple[str, int], int] = {}
    for code in codes:
        for _, _, line in code.co_lines():
            # The first line is the definition itself.
            if line is not None and line > code.co_firstlineno:
                counts[Path(code.co_filename).name, line] = lines[code, line]
    return Reached(calls, counts)


@contextmanager
def _counting(
    codes: dict[CodeType, str], calls: dict[str, int], lines: Counter[tuple[CodeType, int]]
) -> Iterator[None]:
    def entered(frame: Any, event: str, _: Any) -> Any:
        if frame.f_code not in codes:
            return None
        calls[codes[frame.f_code]] += 1
        return in_function

    def in_function(frame: Any, event: str, _: Any) -> Any:
        if event == "line":
            lines[frame.f_code, frame.f_lineno] += 1
        return in_function

    sys.settrace(entered)
    try:
        yield
    finally:
        sys.settrace(None)


def _functions(method: Method) -> list[FunctionType]:
    """Functions of the module of a law or class that its steps may call."""
    law = method.law
    roots: list[Any] = []
    if law is not None:
        roots = [law.function] if law.outputs is None else [law.function, law.outputs]
    elif isinstance(method.factory, type):
        for name in dir(method.factory):
            each = getattr(method.factory, name)
            is_hook = isinstance(each, FunctionType) and not name.startswith("__")
            if is_hook and name not in _BESIDES:
                roots.append(each)
    else:
        return []  # a library, a recording
    module = roots[0].__module__
    return [each for each in Reach(*roots).functions.values() if each.__module__ == module]


def _named(function: FunctionType) -> str:
    code = function.__code__
    return f"{function.__qualname__} ({Path(code.co_filename).name}:{code.co_firstlineno})"


def inexact(method: Method) -> str:
    """The first function that C libraries round differently in what a method reaches, and where.

    Empty if none.
    """
    law = method.law
    roots: list[Any] = []
    if law is not None:
        roots = [law.function, law.outputs]
    else:
        for kind in getattr(method.factory, "__mro__", ()):
            roots += vars(kind).values()
    functions = [each for each in roots if isinstance(each, FunctionType)]
    for function in Reach(*functions).functions.values():
        for line, name in _used(function):
            at = f"{function.__code__.co_filename}, line {line}"
            return f"{at}: {name} is rounded otherwise elsewhere, take it from ev_core.elementary"
    return ""


def _used(function: FunctionType) -> Iterator[tuple[int, str]]:
    """Line and name of each function in `_ROUNDED` that a function takes from math or numpy."""
    line = 0
    module = None
    for each in dis.get_instructions(function):
        if each.positions and each.positions.lineno:
            line = each.positions.lineno
        if each.opname == "LOAD_GLOBAL":
            found = function.__globals__.get(each.argval)
            # By identity, for an array is equal to nothing as a whole.
            module = found if found is math or found is np else None
            own = getattr(found, "__name__", "")
            is_of_math = getattr(found, "__module__", "") == "math"
            if own in _ROUNDED and (is_of_math or isinstance(found, np.ufunc)):
                yield line, own
            continue
        # The name behind the module, as in math.sin.
        is_name = each.opname in ("LOAD_ATTR", "LOAD_METHOD")
        if module is not None and is_name and each.argval in _ROUNDED:
            yield line, f"{module.__name__}.{each.argval}"
