"""The compiler: functions made once, kept on disk, and loaded again by later processes."""

from __future__ import annotations

import hashlib
import linecache
import pickle
import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

from numba.core.caching import NullCache
from numba.core.compiler import CompileResult
from numba.core.registry import cpu_target
from numba.core.serialize import dumps
from numba.extending import register_jitable

from ev_core.compiling.fingerprint import Reach
from ev_core.compiling.inside_numba import only_machine_code_of
from ev_core.compiling.kept_code import forget_older, keep, kept_file, key_of, reach_of
from ev_core.compiling.user_cache import read_checked, write_checked
from ev_msgs_py.compilable import FUNCTIONS, INLINED

# Division by zero gives infinity as in numpy, without a test at each division; sums keep the order in which they are
# written (no fastmath), so results are the same to the bit in every run.
OPTIONS: dict[str, Any] = {"error_model": "numpy"}

_rebuilt: Any = CompileResult._rebuild
_written: Any = dumps
_registered = 0
_reached = Reach()
_functions: dict[str, Any] = {}


def register_functions() -> None:
    """Make all functions that are marked as compilable so far known to the compiler.

    It keeps what it has made of each of them, and forgets that where one is not what it was.
    """
    global _registered, _reached
    if not _reached.holds:
        typing: Any = cpu_target.typing_context
        typing.refresh()
        for known in FUNCTIONS[:_registered]:
            for template in typing.resolve_value_type(known).templates:
                template._impl_cache.clear()
    elif _registered == len(FUNCTIONS):
        return
    while _registered < len(FUNCTIONS):
        function = FUNCTIONS[_registered]
        register_jitable(**OPTIONS, no_cfunc_wrapper=True, forceinline=function in INLINED)(function)
        _registered += 1
    _reached = Reach(*FUNCTIONS)


class _Overloads(NullCache):
    """What numba makes of a function of Python, in files with checksums: one for each choice of types."""

    def __init__(self, key: str, reach: Reach) -> None:
        self._key, self._reach = key, reach

    def load_overload(self, signature: Sequence[Any], target: Any) -> Any:
        """What was kept for these types; None, and a line that it is compiled now, if nothing was."""
        register_functions()
        target.refresh()
        kept = read_checked(self._file(signature))
        if kept is not None:
            return _rebuilt(target, *pickle.loads(kept))
        _say_compiling(self._key)
        return None

    def save_overload(self, signature: Sequence[Any], made: Any) -> None:
        """Keep it, unless it holds addresses of this process, or what it was made of has changed on the way."""
        if self._reach.holds and not made.library.has_dynamic_globals:
            write_checked(self._file(signature), _written(made._reduce()))
            forget_older(self._key)

    def _file(self, signature: Sequence[Any]) -> Path:
        types = repr(_with_names(signature))
        return kept_file(self._key, f"{hashlib.sha256(types.encode()).hexdigest()[:12]}.numba")


def _with_names(kinds: Sequence[Any]) -> list[Any]:
    """Types with the names of what they hold, which numba does not show of a named tuple."""
    return [(kind, getattr(kind, "fields", ()), _with_names(getattr(kind, "types", ()))) for kind in kinds]


def keep_overloads(function: Any) -> Any:
    """Let what numba makes of a function with `njit` be kept on disk; the function itself comes back."""
    names = {"function": function}
    function._cache = _Overloads(key_of(function.__name__, "", names), reach_of("", names))
    return function


def compiled_address(key: str, text: str, names: dict[str, Any]) -> int:
    """The address of the C function `step` of a text, compiled now and kept for who loads it without the compiler.

    Code that holds addresses of this process is not kept: another one would jump to where nothing is.
    """
    _say_compiling(key)
    with only_machine_code_of("step"):
        register_functions()
        step = _executed(key, text, names)
    if not step._library.has_dynamic_globals:
        keep(key, step.native_name, step._library._get_compiled_object())
    address: int = step.address
    return address


def compiled_function(name: str, text: str, names: dict[str, Any]) -> Any:
    """The function `step` of a text that uses these names, compiled or loaded with its first call."""
    key = key_of(name, text, names)
    if key not in _functions:
        _functions[key] = _executed(key, text, names)
        _functions[key]._cache = _Overloads(key, reach_of(text, names))
    return _functions[key]


def _executed(key: str, text: str, names: dict[str, Any]) -> Any:
    module = ModuleType(f"ev_stack_{key}")
    vars(module).update(names)
    sys.modules[module.__name__] = module  # what numba loads from disk asks for its module by name
    file = f"<{key}>"
    linecache.cache[file] = (len(text), None, text.splitlines(keepends=True), file)  # for what the compiler refuses
    exec(compile(text, file, "exec"), vars(module))
    return vars(module)["step"]


def _say_compiling(key: str) -> None:
    name = key.rpartition("_")[0].replace("_", " ")
    print(f"compiling {name} ... (once)", file=sys.stderr, flush=True)
