"""Why a law cannot be compiled, in one line: file, line, what is wrong, what to write instead.

How it works: before a law is compiled, `wrong_text` looks in its text for constructs that would
mean something else compiled, or never end, and `wrong_answer` takes its first step in plain Python.
When the compiler fails nevertheless, it reports the cause in the middle of hundreds of lines.
`mistake` then looks whether plain Python fails as well, which gives the better line, and translates
the compiler's text if it does not.
"""

from __future__ import annotations

import ast
import inspect
import re
import sys
import textwrap
import traceback
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, redirect_stdout
from io import StringIO
from pathlib import Path
from types import FunctionType
from typing import Any

from ev_core.compiled.lists_of_state import wrong_lists
from ev_core.compiled.part_source import law_of
from ev_core.compiled.unassigned import unassigned
from ev_core.compiling.machine_code import TakesInterpreter
from ev_core.methods.index_error import parsed
from ev_core.methods.law import GIVEN, LawObject
from ev_core.methods.law_error import beginning, in_words, is_of_author
from ev_core.methods.method_record import Method
from ev_core.parameters.record import entries_without_number
from ev_msgs_py.compilable import FUNCTIONS
from ev_msgs_py.contract.fields import shape_of
from ev_msgs_py.contract.roles import ROLES, RoleKind
from ev_msgs_py.contract.signals import Instant
from ev_msgs_py.contract.wheels import Wheels

_PLACE = re.compile(
    r'File "(?P<file>[^"<]+)", line (?P<line>\d+)|Raised from (?P<path>\S+) \((?P<at>\d+)\)'
)
_CALLED = re.compile(
    r"resolving callee type: Function\(<(?:built-in function|function|ufunc|class) '?([\w.]+)"
)
_CAUSE = re.compile(
    r"(?:Failed in nopython mode pipeline.*\n\s*"
    r"|raised a specific error:\n\s*\w+: (?!Failed))(\S.*)"
)
# Calls by which an author looks at a law; the compiler knows print, but its code cannot be called
# without Python.
_DEBUGGING = ("print", "breakpoint", "input")
_IN_PYTHON = "needs Python, which runs it, slower and with the same numbers"
_WAYS_OUT = (ast.Break, ast.Return, ast.Raise)
_SHARED = (ast.List, ast.Dict, ast.Set)
# Texts of the compiler, and their meaning for the author of a law; \1 is the content of the first
# bracket.
_MEANINGS = (
    (
        r"Untyped global name '(\w+)':.*<class 'function'>",
        r"\1 is not marked @compilable, as all functions that a law calls",
    ),
    (
        r"Untyped global name '(\w+)':.*<class '(.+?)'>",
        r"\1 is of type \2, expected numbers, tuples and functions marked @compilable",
    ),
    (r"name '(\w+)' is not defined", r"\1 is not defined"),
    (r"use of yield|closure", "a generator or inner function is used, write its terms out"),
    (r"Exception matching", "an exception is caught, test the condition instead"),
    (
        r"Can't index at",
        "a signal or Wheels lacks some of its fields, give all of them: defaults are not compiled",
    ),
    (r"f-string|FORMAT|BUILD_STRING", "a text is made, expected numbers"),
    (
        r"assigned to variable '(\w+)' in globals",
        r"\1 is a list, expected numbers, tuples and functions marked @compilable",
    ),
    (r"unify", "one variable has several types, give it one type in all branches"),
)


def mistake(
    method: Method, parameters: Any, vehicle: Any, period: float, error: BaseException
) -> str:
    """One line about a law for which the compiler has raised an error."""
    law = law_of(method)
    found = _in_python(method, LawObject(law, parameters, vehicle, period))
    return line_about(method, *(found or of_compiler(law.function, error)))


def wrong_answer(method: Method, parameters: Any, vehicle: Any, period: float) -> str:
    """One line about the first step of a law, if its answer is another than its role writes.

    Plain Python takes the step. Empty where the answer is right.
    """
    law = law_of(method)
    if law.heavy:
        return ""  # a step in plain Python would take too long
    try:
        with _unseen():
            found = _of_answer(method, LawObject(law, parameters, vehicle, period))
    except (TypeError, NameError) as error:  # of the text, whatever the inputs are
        found = _raised(error)
    except Exception:
        # Its inputs came out of nowhere: whatever else it raises need not be a mistake.
        return ""
    return line_about(method, *found) if found else ""


def needs_python(method: Method, functions: Iterable[FunctionType], error: BaseException) -> str:
    """One line about a law that cannot be compiled because it prints or the like.

    Empty if that is not why.
    """
    takes = isinstance(error, TakesInterpreter)
    at = None if takes else of_compiler(law_of(method).function, error)[:2]
    for function in functions:
        file, begin = beginning(function)
        for node in ast.walk(_tree(function)):
            match node:
                case ast.Call(func=ast.Name(id=name)) if name in _DEBUGGING:
                    first = begin + node.lineno - 1
                    last = begin + (node.end_lineno or 0)
                    # The compiler names any line of a call that is written over several.
                    if takes or at in [(file, line) for line in range(first, last)]:
                        return line_about(method, file, first, f"{name} {_IN_PYTHON}")
    if not takes:
        return ""
    return line_about(method, *beginning(law_of(method).function), f"it {_IN_PYTHON}")


def wrong_text(method: Method, functions: Iterable[FunctionType]) -> str:
    """One line about the first of these functions that would do something else compiled.

    Empty if there is none.
    """
    law = law_of(method)
    marked = set(FUNCTIONS)
    own = [each for each in (law.function, law.outputs) if each in FUNCTIONS]
    of_state = wrong_lists(own, law.state(), _tree)
    for function in functions:
        # Others are numba's own, or made by it of other texts.
        if function not in marked:
            continue
        arguments: tuple[str, ...] = ()
        if function in own:
            arguments = tuple(inspect.signature(function).parameters)
        found = [*_wrong(function, arguments), *of_state.get(function, ())]
        found += unassigned(_tree(function), function)
        if found:
            node, what = found[0]
            file, line = beginning(function)
            return line_about(method, file, line + node.lineno - 1, what)
    return ""


def line_about(method: Method, file: str, line: int, what: str) -> str:
    """One line about a law."""
    return (
        f"{file}, line {line}: {method.role} law {law_of(method).function.__name__}: {what} "
        "(docs/compiled_laws.md)"
    )


def _wrong(function: FunctionType, arguments: tuple[str, ...]) -> Iterator[tuple[Any, str]]:
    """Mistakes in the text of a function, and why.

    `arguments` are those of a law, which may write only s.
    """
    for node in ast.walk(_tree(function)):
        match node:
            case ast.Global(names=names) | ast.Nonlocal(names=names):
                yield (
                    node,
                    f"{names[0]} is set for all objects of the law, declare it as state (entry)",
                )
            case ast.Import() | ast.ImportFrom():
                yield node, "a module is imported here, import it at the top of the file"
            case ast.Try():
                yield node, "an exception is caught, test the condition instead"
            case ast.While(test=ast.Constant()) if not any(
                isinstance(e, _WAYS_OUT) for e in ast.walk(node)
            ):
                yield node, "the loop never ends, give it a bound: for i in range(n)"
            case ast.Call(func=ast.Name(id=name)) if name == function.__name__:
                yield node, f"{name} calls itself, write a loop"
            case ast.Call(func=ast.Name(id="str" | "repr" | "format" as name)):
                yield node, f"{name} makes a text, expected numbers"
            case ast.Compare() if any(_is_text(each) for each in (node.left, *node.comparators)):
                yield node, "a choice is compared with a text, expected a member of its Choice"
            case ast.Subscript(value=ast.Name(id=name), slice=ast.Constant(value=str(key))) if (
                name in arguments
            ):
                yield node, f'{name}["{key}"] is not known, write {name}.{key}'
            case ast.arguments(vararg=ast.arg() as many) | ast.arguments(kwarg=ast.arg() as many):
                yield many, f"{many.arg} stands for any number of arguments, name each of them"
            case ast.arguments() if shared := [
                each for each in node.defaults if isinstance(each, _SHARED)
            ]:
                yield shared[0], "this default is one for all calls, declare it as state (entry)"
    for node, name in _assigned(function):
        root = re.split(r"\W", name)[0]
        if root in arguments and root != "s":
            instead = "what changes is state (entry)" if root in GIVEN else "make a new signal"
            yield node, f"{name} is written, {root} is only read: {instead}"


def _is_text(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def _assigned(function: Callable[..., Any]) -> Iterator[tuple[ast.expr, str]]:
    """Attributes and elements that a function assigns to, with their text."""
    for node in ast.walk(_tree(function)):
        if isinstance(node, ast.Attribute | ast.Subscript) and isinstance(node.ctx, ast.Store):
            yield node, ast.unparse(node)


def _tree(function: Callable[..., Any]) -> ast.AST:
    """Syntax tree of a function.

    It is that of an empty module where its text is not known, as of a lambda.
    """
    if function.__name__ == "<lambda>":
        return parsed("")
    try:
        return parsed(textwrap.dedent(inspect.getsource(function)))
    except OSError:
        return ast.Module([], [])


@contextmanager
def _unseen() -> Iterator[None]:
    """Let a law print nothing, and stop at no breakpoint: it is not a step of a run."""
    hook, sys.breakpointhook = sys.breakpointhook, lambda *_, **__: None
    try:
        with redirect_stdout(StringIO()):
            yield
    finally:
        sys.breakpointhook = hook


def _in_python(method: Method, made: LawObject) -> tuple[str, int, str] | None:
    """Mistake that one step in plain Python finds; None if it finds none."""
    try:
        with _unseen():
            return _of_answer(method, made)
    except Exception as error:  # whatever the law raises
        return _raised(error)


def _raised(error: Exception) -> tuple[str, int, str] | None:
    """Line of the author's text that has raised an error, and the error in words.

    None if no line of it has.
    """
    frames = traceback.extract_tb(error.__traceback__)
    own = [each for each in frames if is_of_author(each.filename)]
    if not own or own[-1].filename == __file__:
        return None
    return own[-1].filename, own[-1].lineno or 0, in_words(error)


def _of_answer(method: Method, made: LawObject) -> tuple[str, int, str] | None:
    """Mistake in the answer of one step or in the state behind it; None if there is none."""
    law = law_of(method)
    signals: list[Any] = []
    for kind in method.reads:
        if kind is Instant:
            signals.append(Instant(0.0))
        else:
            # Ones, for the first step of a law may divide by what it reads.
            shape = shape_of(kind)
            signals.append(shape.signal_of([1.0] * shape.size))
    given = made.step(*signals)
    for name, value in entries_without_number(made.given["s"]):
        file, begin = beginning(law.function)
        line = _line_that_writes(law.function, name)
        return file, begin + line - 1, f"s.{name} becomes {type(value).__name__}, expected a number"
    if ROLES[method.role].kind is RoleKind.INTEGRATES:
        given = made.outputs()
    wrote = given if isinstance(given, tuple) and not hasattr(given, "_fields") else (given,)
    at = beginning(law.outputs or law.function)
    if [type(each) for each in wrote] != [*method.writes]:
        returned = " and ".join(type(each).__name__ for each in wrote)
        expected = " and ".join(each.__name__ for each in method.writes)
        return *at, f"it returns {returned}, expected {expected}"
    for kind, signal in zip(method.writes, wrote, strict=True):
        per_wheel = shape_of(kind).per_wheel
        for name, value in zip(signal._fields, signal, strict=True):
            if per_wheel and not isinstance(value, Wheels):
                what = f"{name} of its {kind.__name__} is {type(value).__name__}"
                return *at, f"{what}, expected Wheels: Wheels(a, b, c, d)"
    return None


def _line_that_writes(function: Callable[..., Any], name: str) -> int:
    """Line of a function's text that assigns to an entry of the state; 1 if none does."""
    for node, text in _assigned(function):
        # A record or a list is written as a whole, or an element of it.
        if f"s.{name}.".startswith(f"{text.partition('[')[0]}."):
            return node.lineno
    return 1


def of_compiler(function: Callable[..., Any], error: BaseException) -> tuple[str, int, str]:
    """File, line and finding of the compiler: its last line that belongs to no library.

    It is the beginning of the compiled function where no such line is named.
    """
    text = str(error)
    places: list[re.Match[str]] = []
    for found in _PLACE.finditer(text):
        if is_of_author(found["file"] or found["path"]):
            places.append(found)
    before = text[: places[-1].start()] if places else text
    what = _meaning(text) or _cause(text, before) or type(error).__name__
    if not places:
        return *beginning(function), what
    place = places[-1]
    file = Path(place["file"] or place["path"]).resolve()
    return str(file), int(place["line"] or place["at"]), what


def _meaning(text: str) -> str:
    """The meaning of the compiler's text for the author; empty if it is not known."""
    for pattern, meaning in _MEANINGS:
        if found := re.search(pattern, text):
            return found.expand(meaning)
    return ""


def _cause(text: str, before: str) -> str:
    """The cause in the compiler's own words; `before` is its text up to the author's last line."""
    if called := _CALLED.findall(before):
        return f"{called[-1]} is not compiled for what it is given here"
    causes = _CAUSE.findall(text) or [line for line in text.splitlines() if line.strip()]
    return causes[-1] if causes else ""
