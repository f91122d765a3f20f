"""Functions as machine code.

They are compiled once, loaded from the store without the compiler, and called by their address.

How it works: a caller gives a short text with a function `step` and the objects that the text
names. Its key changes with all that the text reaches (`code_store`). `function_address` looks for
the key in this process, then on disk, and compiles at last; one process compiles while others wait
for its file. Loading numba takes longer than a node takes to start, so that it is imported only
where a text has to be compiled.

The compiler knows all functions that are marked as compilable. What it has made of them is
forgotten when one of them has changed. Sums keep the order in which they are written (no fastmath),
so results are the same to the bit in every run.
"""

from __future__ import annotations

import ctypes
import hashlib
import linecache
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

from ev_core.compiling import inside_numba, inside_numba_checks, inside_numba_code
from ev_core.compiling.code_store import forget_older, keep, kept_code, kept_file, key_of, reach_of
from ev_core.compiling.fingerprint import Reach
from ev_core.compiling.user_cache import alone, read_checked, write_checked
from ev_msgs_py.compilable import FUNCTIONS, INLINED

FUNCTION = ctypes.CFUNCTYPE(ctypes.c_int32, *[ctypes.c_void_p] * 4)
_DIGITS = 12  # of a name for the types of one call

_registered = 0  # functions that the compiler knows, the first ones of FUNCTIONS
_reached = Reach()  # of these
_functions: dict[str, Any] = {}
_addresses: dict[str, int] = {}
_taking: set[str] = set()  # keys of code that takes the interpreter
_is_announced = True  # by a line for each text that is compiled


class TakesInterpreter(Exception):
    """Compiled code takes Python's interpreter at run time.

    The interpreter is not there when code is called by its address.
    """


def call(address: int, first: int, second: int, third: int, fourth: int) -> int:
    """Call a C function by its address, with up to four pointers or integers.

    The result is its status. It is called in the same way from compiled code and from plain Python.
    """
    status: int = FUNCTION(address)(first, second, third, fourth)
    return status


def function_address(
    name: str, text: str, names: dict[str, Any], look_at: Callable[[Reach], None] = lambda _: None
) -> int:
    """The address of the C function `step` of a text that uses these names.

    It is loaded from disk, or compiled first. Before it is compiled, `look_at` is called with all
    that the text reaches, and may refuse it.
    """
    key = key_of(name, text, names)
    if key in _taking:
        look_at(reach_of(text, names))
        raise TakesInterpreter
    if key not in _addresses:
        address = _loaded(key)
        if not address:
            look_at(reach_of(text, names))
            with alone(key):
                address = _loaded(key) or compiled_address(key, text, names)
        _addresses[key] = address
    return _addresses[key]


def _loaded(key: str) -> int:
    kept = kept_code(key)
    return inside_numba_code.loaded(*kept) if kept else 0


class Code(NamedTuple):
    """A text with a C function `step`, its name and the names that it uses."""

    name: str
    text: str
    names: dict[str, Any]

    def is_kept(self) -> bool:
        """Return whether its machine code is on disk, so that it need not be compiled."""
        return kept_code(key_of(*self)) is not None

    def address(self) -> int:
        """The address of the function, which is compiled where it is not kept."""
        return function_address(*self)


@cache
def _make_known() -> None:
    """Let the compiler know `call`, working memory and choices."""
    from llvmlite import ir
    from numba import types
    from numba.extending import intrinsic, overload

    def called(typing: Any, address: Any, first: Any, second: Any, third: Any, fourth: Any) -> Any:
        def lowered(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            pointer = ir.IntType(8).as_pointer()
            function = builder.inttoptr(
                arguments[0], ir.FunctionType(ir.IntType(32), [pointer] * 4).as_pointer()
            )
            return builder.call(
                function, [builder.inttoptr(word, pointer) for word in arguments[1:]]
            )

        return types.int32(*[types.intp] * 5), lowered

    at: Any = intrinsic(called)
    overload(call)(
        lambda address, first, second, third, fourth: (
            lambda address, first, second, third, fourth: at(address, first, second, third, fourth)
        )
    )
    inside_numba.make_memory_known()
    inside_numba.make_choices_known()
    inside_numba_checks.make_checks_reach_callees()


def register_functions() -> None:
    """Let the compiler know all functions marked as compilable, and forget changed ones."""
    global _registered, _reached
    from numba.extending import register_jitable

    _make_known()
    if not _reached.holds:
        inside_numba.forget_made_of(FUNCTIONS[:_registered])
    elif _registered == len(FUNCTIONS):
        return
    while _registered < len(FUNCTIONS):
        function = FUNCTIONS[_registered]
        options = {
            "error_model": inside_numba_checks.error_model(),
            "forceinline": function in INLINED,
        }
        register_jitable(no_cfunc_wrapper=True, **options)(function)
        _registered += 1
    _reached = Reach(*FUNCTIONS)


def made_by_others(text: str, names: dict[str, Any]) -> list[Any]:
    """Objects that numba has made of functions that a text reaches (njit, ...), callees first."""
    return sorted(reach_of(text, names).made, key=lambda each: len(Reach(each).functions))


def _keep(function: Any, key: str, reach: Reach) -> None:
    def file(kinds: str) -> Path:
        return kept_file(key, f"{hashlib.sha256(kinds.encode()).hexdigest()[:_DIGITS]}.numba")

    def read(kinds: str) -> bytes | None:
        kept = read_checked(file(kinds))
        if kept is None:
            _announce(key)
        return kept

    def write(kinds: str, made: bytes) -> None:
        if reach.holds:  # and has not changed on the way
            write_checked(file(kinds), made)
            forget_older(key)

    inside_numba_code.keep_overloads(function, register_functions, lambda: alone(key), read, write)


def compiled_address(key: str, text: str, names: dict[str, Any]) -> int:
    """The address of the C function `step` of a text, compiled now.

    It is kept for processes without the compiler. Code that holds addresses of this process is not
    kept: another process would jump into nowhere. TakesInterpreter if it cannot be called by its
    address.
    """
    _announce(key)
    with inside_numba.only_machine_code_of("step", made_by_others(text, names)):
        register_functions()
        step = executed(key, text, names)
    if inside_numba_code.takes_interpreter(step):
        _taking.add(key)
        raise TakesInterpreter
    if made := inside_numba_code.object_code(step):
        keep(key, *made)
    address: int = step.address
    return address


def compiled_function(name: str, text: str, names: dict[str, Any]) -> Any:
    """The function `step` of a text with these names, compiled or loaded by its first call."""
    key = key_of(name, text, names)
    if key not in _functions:
        inside_numba.make_anew(made_by_others(text, names))
        register_functions()
        _functions[key] = executed(key, text, names)
        _keep(_functions[key], key, reach_of(text, names))
    return _functions[key]


def executed(key: str, text: str, names: dict[str, Any]) -> Any:
    """The function `step` of a text that uses these names, in a module of its own."""
    module = ModuleType(f"ev_stack_{key}")
    vars(module).update(names)
    # Code that numba loads from disk asks for its module by name.
    sys.modules[module.__name__] = module
    file = f"<{key}>"
    # The compiler's errors show lines of the text.
    linecache.cache[file] = (len(text), None, text.splitlines(keepends=True), file)
    exec(compile(text, file, "exec"), vars(module))
    return vars(module)["step"]


@contextmanager
def counted_by_others() -> Iterator[None]:
    """Print no line about each text that is compiled in this block.

    Its caller shows the progress.
    """
    global _is_announced
    before, _is_announced = _is_announced, False
    try:
        yield
    finally:
        _is_announced = before


def _announce(key: str) -> None:
    if _is_announced:
        name = key.rpartition("_")[0].replace("_", " ")
        print(f"compiling {name} ... (once)", file=sys.stderr, flush=True)
