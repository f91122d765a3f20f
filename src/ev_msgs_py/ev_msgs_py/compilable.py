"""The mark of what may run compiled; it changes nothing for Python, its debugger and `print`."""

from collections.abc import Callable
from typing import Any, TypeVar

F = TypeVar("F", bound=Callable[..., Any])

FUNCTIONS: list[Callable[..., Any]] = []
INLINED: set[Callable[..., Any]] = set()


def compilable(function: F) -> F:
    """Mark a function that compiled code may call, and return it unchanged.

    Its text is restricted to what means the same in Python and compiled, to the bit:
    docs/compiled_laws.md.
    """
    FUNCTIONS.append(function)
    return function


def inlined(function: F) -> F:
    """Mark a function as `compilable` that the compiler shall put into the place of each call.

    For what runs several times within each step of the plant: handing over its arguments would cost
    as much as its work. It takes the compiler longer.
    """
    INLINED.add(function)
    return compilable(function)
