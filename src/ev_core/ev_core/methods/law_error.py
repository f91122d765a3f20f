"""A mistake of a law's author in one line: file, line, law, what is wrong, what to write instead.

How it works: every call of an author's function is made in a block `in_law`, or passes its error to
`raise_in_one_line`: preparing, starting, stepping, state, notes, needs, files. So the line is the
same offline, over DDS and in the checks. The place is the last line of the traceback that is the
author's own.
"""

from __future__ import annotations

import inspect
import sysconfig
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import fields, is_dataclass
from difflib import get_close_matches
from functools import partial
from pathlib import Path
from traceback import extract_tb
from types import SimpleNamespace
from typing import Any, NoReturn

from ev_core.methods.index_error import index_in_words
from ev_msgs_py.contract.fields import SignalError
from ev_msgs_py.refusal import ParameterError, shown

# Files of libraries, or of code that calls the author's functions: they are no place of his
# mistake.
_OURS = (str(Path(__file__).parents[1]), str(Path(inspect.getfile(ParameterError)).parent))
_OF_OTHERS = (*_OURS, sysconfig.get_path("stdlib"), "<", "numba/")
_PACKAGES = "site-packages"
BY_AUTHORS = (Exception, SystemExit)  # errors that a law may raise; an interrupt is the user's
_REFUSALS = (ParameterError, SignalError, MemoryError)  # in one line already, or not of the law


class LawError(ParameterError):
    """A mistake in a law, in one line; the law's own error is its `__cause__`."""


class WrongResultError(TypeError):
    """A function of a law returns something else than it has to."""

    def __init__(self, function: Any, given: Any, expected: str) -> None:
        super().__init__(f"{named(function)} gives {kind_of(given)}, expected {expected}")
        self.function = function


@contextmanager
def in_law(method: Any, function: Any = None) -> Iterator[None]:
    """Turn a mistake of the author of a method in this block into one line, LawError.

    Refusals remain what they are. Where none of the author's lines raises it, it stands in the
    `function`, or in the method's own.
    """
    try:
        yield
    except BY_AUTHORS as error:
        raise_in_one_line(method, error, function=function)


def raise_in_one_line(
    method: Any, error: BaseException, time: float | None = None, function: Any = None
) -> NoReturn:
    """Raise a refusal as it is, anything else as LawError.

    Its line has the time of the step [s] if it was one.
    """
    if isinstance(error, _REFUSALS):
        raise error
    at = _place(error, function or method.documented)
    step = "" if time is None else f"at {time:g} s: "
    law = f"{method.role} law {getattr(method.documented, '__name__', method.name)}"
    raise LawError(f"{step}{at}{law}: {_in_words(error, time is not None)}") from error


def in_words(error: BaseException) -> str:
    """The text of an error; of an attribute that is not known with the nearest known ones."""
    if not isinstance(error, AttributeError) or error.obj is None:
        return " ".join(str(error).split())
    # Parameters and car are namespaces, signals named tuples, the state is a dataclass.
    known: Iterable[str] = getattr(error.obj, "_fields", ())
    if isinstance(error.obj, SimpleNamespace):
        known = vars(error.obj)
    elif is_dataclass(error.obj):
        known = [each.name for each in fields(error.obj)]
    nearest = " or ".join(get_close_matches(error.name or "", known))
    if nearest:
        return f"{error.name} is not known here, perhaps {nearest} is meant"
    return f"{error.name} is not known here"


def is_of_author(file: str) -> bool:
    """Return whether a file may hold an author's text: it belongs to no library."""
    return _PACKAGES not in file and not file.startswith(_OF_OTHERS)


def beginning(function: Any) -> tuple[str, int]:
    """File and line in which the text of a function or of a class begins.

    No file if that is not known.
    """
    while isinstance(function, partial):
        function = function.func
    code = getattr(inspect.unwrap(function), "__code__", None)
    if code is not None:
        return code.co_filename, code.co_firstlineno
    try:
        return inspect.getfile(function), inspect.findsource(function)[1] + 1
    except (OSError, TypeError):  # of a notebook, or of no Python
        return "", 0


def _place(error: BaseException, function: Any) -> str:
    """Place of the author's mistake.

    It is the last of the author's lines, or the beginning of the function that failed.
    """
    own = beginning(function)
    frames = [(each.filename, each.lineno or 0) for each in extract_tb(error.__traceback__)]
    lines = [(file, line) for file, line in frames if file == own[0] or is_of_author(file)]
    if isinstance(error, WrongResultError):
        lines = [beginning(error.function)]
    file, line = lines[-1] if lines else own
    return f"{file}, line {line}: " if file else ""


def _in_words(error: BaseException, steps: bool) -> str:
    if isinstance(error, WrongResultError):
        return str(error)
    if isinstance(error, IndexError) and (index := index_in_words(error)):
        return index
    text = shown(f"{type(error).__name__}: {in_words(error)}".removesuffix(": "))
    if isinstance(error, ZeroDivisionError):
        return f"{text}; test the divisor first{', speeds are 0 at rest' if steps else ''}"
    if isinstance(error, SystemExit):
        return f"{text}; a law does not end the program, expected an exception such as ValueError"
    return text


def named(function: Callable[..., Any]) -> str:
    """The name of a function, also of one with arguments that are given already."""
    while isinstance(function, partial):
        function = function.func
    return getattr(function, "__name__", type(function).__name__)


def kind_of(given: Any) -> str:
    """Kind of a returned value, in words."""
    if given is None:
        return "nothing"
    if type(given) in (tuple, list):
        elements = ", ".join(type(each).__name__ for each in given) or "nothing"
        return f"a {type(given).__name__} of {elements}"
    return type(given).__name__


def notes_of(function: Callable[[], Any]) -> tuple[str, ...]:
    """Notes of an author's function; WrongResultError unless they are texts in a tuple."""
    notes = function()
    if not isinstance(notes, (tuple, list)) or not all(isinstance(each, str) for each in notes):
        raise WrongResultError(function, notes, "a tuple of texts: (text,)")
    return tuple(notes)
