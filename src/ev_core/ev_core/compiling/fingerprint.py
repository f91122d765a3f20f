"""A digest of all that the compiled form of some functions depends on.

numba keeps a compiled function until its own file changes. It would not notice that a function
which this one calls, or a number which it takes from another module, has changed, and the old
results would come back.

How it works: from some functions and values, `Reach` follows the names in their code through
modules, defaults and closures to other functions and values, and adds all of them to a digest in
the order in which they are found. It keeps the objects that it has found at each name, so that
`holds` only compares identities.
"""

from __future__ import annotations

import builtins
import dis
import hashlib
import os
import sys
from collections.abc import Iterator, Mapping
from functools import partial
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

from ev_core.compiling.inside_numba import options_of
from ev_msgs_py.compilable import INLINED

_NOTHING = object()
# their versions determine their content, like Python's own
_FOREIGN = ("numpy", "numba", "llvmlite")
_OF_PYTHON = os.path.dirname(os.__file__)


def fingerprint(*roots: Any) -> str:
    """Hexadecimal digits of all functions that are reached, and of all their constants."""
    return Reach(*roots).digits


class Reach:
    """All that some functions and values reach.

    They do so by the names in their code, through modules, defaults and closures. `digits` are its
    digest, `functions` those that were found, `made` the objects that numba has made of some of
    them.
    """

    def __init__(self, *roots: Any) -> None:
        self.functions: dict[int, FunctionType] = {}
        self.made: list[Any] = []
        self._looked_up: list[tuple[Mapping[str, Any], str, Any]] = []
        self._made_of: list[tuple[FunctionType, tuple[Any, ...]]] = []
        self._arrays: list[tuple[np.ndarray | np.generic, bytes]] = []
        self._digest = hashlib.sha256()
        waiting = [*reversed(roots)]
        while waiting:
            # In the order in which they are found, without recursion, which would go deep.
            waiting += reversed([*self._followed(waiting.pop())])
        self.digits = self._digest.hexdigest()

    @property
    def holds(self) -> bool:
        """True as long as nothing of it has changed."""
        return (
            all(space.get(name, _NOTHING) is value for space, name, value in self._looked_up)
            and all(_are_same(_parts(function), parts) for function, parts in self._made_of)
            and all(array.tobytes() == content for array, content in self._arrays)
        )

    def _followed(self, found: Any) -> Iterator[Any]:
        """Add an object to the digest, and yield the objects to which it leads."""
        function = _written(found)
        if isinstance(function, FunctionType) and function is not found:
            self.made.append(found)
        if isinstance(found, tuple | list):
            self._add(_constant(type(found)), len(found))
            yield from found
        elif isinstance(found, np.ndarray | np.generic):
            # By its bytes: what numpy shows of a long array is not all of it.
            content = found.tobytes()
            self._arrays.append((found, content))
            self._add(found.dtype, found.shape, hashlib.sha256(content).hexdigest())
        elif not isinstance(function, FunctionType):
            self._add(_constant(found))
            if hasattr(found, "class_type"):  # a jitclass
                yield from options_of(found)
        elif id(function) in self.functions:
            self._add("again", [*self.functions].index(id(function)))
        else:
            self.functions[id(function)] = function
            self._made_of.append((function, _parts(function)))
            self._add(
                f"{function.__module__}.{function.__qualname__}",
                function in INLINED,
                *options_of(found),
            )
            self._digest.update(_code(function.__code__) + b"\0")
            yield from self._used_by(function)

    def _add(self, *what: Any) -> None:
        # With an end after each: else "ab" and "c" would be "a" and "bc".
        self._digest.update(f"{' '.join(map(str, what))}\0".encode())

    def _used_by(self, function: FunctionType) -> Iterator[Any]:
        """Objects that a function takes from outside, each behind its name."""
        names = list(_names(function.__code__))
        places: list[Mapping[str, Any]] = [function.__globals__]
        # Modules that are found on the way are added to the places.
        for place in places:
            for name in names:
                found = place.get(name, _NOTHING)
                # A name of Python's own is looked up, too, for a global one may come to hide it.
                if found is not _NOTHING or hasattr(builtins, name):
                    self._looked_up.append((place, name, found))
                if found is not _NOTHING:
                    yield from (name, found)
                    if _is_looked_into(found) and not any(vars(found) is each for each in places):
                        places.append(vars(found))
        yield from (function.__defaults__, tuple((function.__kwdefaults__ or {}).items()))
        yield tuple(_contents(function))


def _written(found: Any) -> Any:
    """The written function of an object that numba made of it (njit, cfunc, vectorize).

    Else the object itself.
    """
    if isinstance(found, FunctionType):
        return found
    return getattr(found, "py_func", getattr(found, "__wrapped__", found))


def _are_same(one: tuple[Any, ...], other: tuple[Any, ...]) -> bool:
    """Return whether two rows hold the same objects."""
    return len(one) == len(other) and all(a is b for a, b in zip(one, other, strict=True))


def _parts(function: FunctionType) -> tuple[Any, ...]:
    """Objects that a function consists of.

    They may be replaced while its name keeps the same function.
    """
    by_name = function.__kwdefaults__ or {}
    return (
        function.__code__,
        function.__defaults__,
        *by_name,
        *by_name.values(),
        *_contents(function),
    )


def _contents(function: FunctionType) -> Iterator[Any]:
    for cell in function.__closure__ or ():
        try:
            yield cell.cell_contents
        except ValueError:  # not filled yet
            yield _NOTHING


def _is_looked_into(found: Any) -> bool:
    """Return whether an object is a module of the user's.

    It may have the name of a module of Python's.
    """
    if not isinstance(found, ModuleType):
        return False
    package = found.__name__.partition(".")[0]
    file = getattr(found, "__file__", None) or _OF_PYTHON
    return package not in _FOREIGN and not (
        package in sys.stdlib_module_names and file.startswith(_OF_PYTHON)
    )


def _code(code: CodeType) -> bytes:
    """A function's instructions, in bytes that do not depend on its place in a file."""
    constants = [
        _code(each) if isinstance(each, CodeType) else repr(each).encode()
        for each in _used_constants(code)
    ]
    called = (code.co_argcount, code.co_posonlyargcount, code.co_kwonlyargcount, code.co_flags)
    names = repr((code.co_names, code.co_varnames, code.co_freevars, called)).encode()
    return b"\0".join((code.co_code, names, *constants))


def _used_constants(code: CodeType) -> tuple[Any, ...]:
    """A function's constants without its docstring, which changes nothing of what it does.

    The docstring is the first constant. Instructions are pairs of an operation and its argument.
    """
    constants = code.co_consts
    if not constants or not isinstance(constants[0], str):
        return constants
    pairs = zip(code.co_code[::2], code.co_code[1::2], strict=True)
    is_used = any(operation in dis.hasconst and place == 0 for operation, place in pairs)
    return constants if is_used else constants[1:]


def _names(code: CodeType) -> Iterator[str]:
    yield from code.co_names
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _names(constant)


def _constant(value: Any) -> str:
    if value is _NOTHING:
        return ""
    if isinstance(value, ModuleType):
        return value.__name__
    if isinstance(value, type):
        fields = getattr(value, "_fields", "")
        members = dict(getattr(value, "__members__", {}))
        return f"{value.__qualname__}{fields}{members}"
    # Numba does not call it. It is there by its name only, and would show an address.
    if isinstance(value, partial):
        return f"partial {getattr(value.func, '__qualname__', type(value.func))}"
    return repr(value)
