"""The mark of what may run compiled; it changes nothing for Python, its debugger and `print`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

F = TypeVar("F", bound=Callable[..., Any])

FUNCTIONS: list[Callable[..., Any]] = []


def compilable(function: F) -> F:
    """Mark a function that compiled code may call, and return it unchanged.

    Its text is restricted to what means the same in Python and compiled, to the bit: docs/compiled_laws.md.
    """
    FUNCTIONS.append(function)
    return function
