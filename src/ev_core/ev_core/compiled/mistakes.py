"""Why a law cannot be compiled, in one line: file, line, what is wrong, what to write instead.

The compiler says the same in hundreds of lines of its own text, with the cause in the middle.
"""

from __future__ import annotations

import inspect
import re
import traceback
from difflib import get_close_matches
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from ev_core.methods.law import Law, LawObject
from ev_core.methods.register import Method
from ev_msgs_py.contract.fields import shape_of
from ev_msgs_py.contract.roles import ROLES, RoleKind
from ev_msgs_py.contract.signals import Instant

_PLACE = re.compile(r'File "(?P<file>[^"<]+)", line (?P<line>\d+)|Raised from (?P<path>\S+) \((?P<at>\d+)\)')
_CALLED = re.compile(r"resolving callee type: Function\(<(?:built-in function|function|ufunc|class) '?([\w.]+)")
_CAUSE = re.compile(r"(?:Failed in nopython mode pipeline.*\n\s*|raised a specific error:\n\s*\w+: (?!Failed))(\S.*)")
_OTHERS = "site-packages"  # of a path: no text of ours or of the user
# What the compiler says, and what that means for who writes a law; \1 is what stands in the first bracket.
_MEANINGS = (
    (
        r"Untyped global name '(\w+)':.*<class 'function'>",
        r"\1 is not marked @compilable, as all functions that a law calls",
    ),
    (
        r"Untyped global name '(\w+)':.*<class '(.+?)'>",
        r"\1 is of type \2, allowed are numbers, tuples and functions marked @compilable",
    ),
    (r"name '(\w+)' is not defined", r"\1 is not defined"),
    (r"use of yield|closure", "a generator or inner function is used, write its terms out"),
    (r"Exception matching", "an exception is caught, test the condition instead"),
    (r"Can't index at", "a signal or Wheels lacks some of its fields, give all of them: defaults are not compiled"),
    (r"f-string|FORMAT|BUILD_STRING", "a text is made, allowed are numbers"),
    (
        r"assigned to variable '(\w+)' in globals",
        r"\1 is a list, allowed are numbers, tuples and functions marked @compilable",
    ),
    (r"unify", "one variable has several types, give it one type in all branches"),
)


def mistake(method: Method, parameters: Any, vehicle: Any, period: float, error: BaseException) -> str:
    """One line about a law for which the compiler has raised an error."""
    law = method.law
    assert law is not None
    file, line, what = _in_python(law, method, LawObject(law, parameters, vehicle, period)) or _of_compiler(law, error)
    return f"{file}, line {line}: {method.role} law {law.function.__name__}: {what} (docs/compiled_laws.md)"


def _in_python(law: Law, method: Method, made: LawObject) -> tuple[str, int, str] | None:
    """What plain Python finds wrong with one step; None if it finds nothing."""
    signals = [
        Instant(0.0) if kind is Instant else shape_of(kind).signal_of([1.0] * shape_of(kind).size)
        for kind in method.reads
    ]
    integrates = ROLES[method.role].kind is RoleKind.INTEGRATES
    try:
        given = made.step(*signals)
        if integrates:
            given = made.outputs()
    except Exception as error:  # whatever the law raises
        frames = [each for each in traceback.extract_tb(error.__traceback__) if _is_theirs(each.filename)]
        at = frames[-1] if frames else None
        return (at.filename, at.lineno or 0, _in_words(error)) if at and at.filename != __file__ else None
    wrote = given if isinstance(given, tuple) and not hasattr(given, "_fields") else (given,)
    if [type(each) for each in wrote] == [*method.writes]:
        return None
    function = law.outputs or law.function
    names = [" and ".join(each.__name__ for each in kinds) for kinds in (map(type, wrote), method.writes)]
    return *_beginning(function), f"it returns {names[0]}, allowed is {names[1]}"


def _in_words(error: Exception) -> str:
    if not isinstance(error, AttributeError) or error.obj is None:
        return str(error)
    known = vars(error.obj) if isinstance(error.obj, SimpleNamespace) else getattr(error.obj, "_fields", ())
    nearest = " or ".join(get_close_matches(error.name or "", known))
    return f"{error.name} is not known here" + (f", perhaps {nearest} is meant" if nearest else "")


def _of_compiler(law: Law, error: BaseException) -> tuple[str, int, str]:
    """What the compiler found, at the last line of no library that it names."""
    text = str(error)
    places = [found for found in _PLACE.finditer(text) if _is_theirs(found["file"] or found["path"])]
    for pattern, meaning in _MEANINGS:
        if found := re.search(pattern, text):
            what = found.expand(meaning)
            break
    else:
        called = _CALLED.findall(text[: places[-1].start()] if places else text)
        causes = _CAUSE.findall(text) or [line for line in text.splitlines() if line.strip()] or [type(error).__name__]
        what = f"{called[-1]} is not compiled for what it is given here" if called else causes[-1]
    if not places:
        return *_beginning(law.function), what
    place = places[-1]
    return str(Path(place["file"] or place["path"]).resolve()), int(place["line"] or place["at"]), what


def _is_theirs(file: str) -> bool:
    return _OTHERS not in file and not file.startswith(("<", "numba/"))


def _beginning(function: Any) -> tuple[str, int]:
    """File and line in which the text of a function begins."""
    code = inspect.unwrap(function).__code__
    return code.co_filename, code.co_firstlineno
