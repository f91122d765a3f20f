"""A digest of everything that the compiled form of some functions depends on.

numba keeps a compiled function until its own file changes; that a function it calls, or a number that it takes from
another module, has changed goes unnoticed, and the old results would come back.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from types import CodeType, FunctionType, ModuleType
from typing import Any

from ev_msgs_py.compiling.compilable import INLINED


def fingerprint(*roots: Any) -> str:
    """Hexadecimal digits that change with what any function reached does, and with all their constants."""
    digest = hashlib.sha256()
    seen: set[int] = set()
    waiting = list(reversed(roots))
    while waiting:
        found = waiting.pop()
        function = getattr(found, "py_func", found)
        if isinstance(found, tuple | list):
            digest.update(f"{_constant(type(found))} {len(found)}\0".encode())
            waiting += reversed(found)
        elif not isinstance(function, FunctionType):
            digest.update(f"{_constant(found)}\0".encode())
        elif id(function) not in seen:
            seen.add(id(function))
            digest.update(f"{function.__module__}.{function.__qualname__}\0{function in INLINED}\0".encode())
            digest.update(f"{getattr(found, 'targetoptions', '')}\0".encode())
            digest.update(_code(function.__code__) + b"\0")
            waiting += reversed(list(_used_by(function)))
    return digest.hexdigest()


def _used_by(function: FunctionType) -> Iterator[Any]:
    """What a function takes from outside of it, by the names in its code, and its defaults."""
    names = list(_names(function.__code__))
    places = [function.__globals__]
    for place in places:  # and the modules found on the way
        for found in (place[name] for name in names if name in place):
            yield found
            if _is_looked_into(found) and not any(vars(found) is each for each in places):
                places.append(vars(found))
    yield from (function.__defaults__, function.__kwdefaults__)
    for cell in function.__closure__ or ():
        yield cell.cell_contents


def _is_looked_into(found: Any) -> bool:
    return isinstance(found, ModuleType) and hasattr(found, "__file__") and not found.__name__.startswith("numpy")


def _code(code: CodeType) -> bytes:
    """What a function does, in bytes that do not depend on where its text stands."""
    constants = [_code(each) if isinstance(each, CodeType) else repr(each).encode() for each in code.co_consts]
    names = repr((code.co_names, code.co_varnames, code.co_freevars)).encode()
    return b"\0".join((code.co_code, names, *constants))


def _names(code: CodeType) -> Iterator[str]:
    yield from code.co_names
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _names(constant)


def _constant(value: Any) -> str:
    if isinstance(value, ModuleType):
        return value.__name__
    if isinstance(value, type):
        return f"{value.__qualname__}{getattr(value, '_fields', '')}{dict(getattr(value, '__members__', {}))}"
    if hasattr(value, "tobytes"):  # what numpy shows of a long array is not all of it
        return f"{value.dtype} {value.shape} {value.tobytes().hex()}"
    return repr(value)
