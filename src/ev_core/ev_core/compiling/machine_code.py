"""Functions as machine code: compiled once, kept on disk, loaded without the compiler, and called by their address.

The files are named by everything that they depend on: text, reach, processor, compiler. Loading numba takes longer than
a node takes to start: it is imported where something has to be compiled.
"""

from __future__ import annotations

import ctypes
import hashlib
import linecache
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from importlib.metadata import version
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

from ev_core.compiling import inside_numba, inside_numba_checks, inside_numba_code
from ev_core.compiling.fingerprint import Reach
from ev_core.compiling.user_cache import alone, cache_folder, read_checked, write_checked
from ev_msgs_py.compilable import FUNCTIONS, INLINED


class TakesInterpreter(Exception):
    """Compiled code takes Python's interpreter at run time: called by its address it has none of what that needs."""


FUNCTION = ctypes.CFUNCTYPE(ctypes.c_int32, *[ctypes.c_void_p] * 4)

# Settings of the compiler that change what it makes.
_SETTINGS = ("NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES", "NUMBA_OPT", "NUMBA_BOUNDSCHECK", inside_numba.VARIABLE)
_KEPT_TEXTS = 8  # of one name: those of other checkouts, of branches and of tests come back
_MAKERS = ("numba", "llvmlite", "numpy")
# Modules that give the compiler what no text shows: its options, and its treatment of our functions.
_TELLING = ("inside_numba", "inside_numba_checks", "inside_numba_code", "machine_code")
_DIGITS = 12
_CODE = "code"

_registered = 0
_reached = Reach()
_functions: dict[str, Any] = {}
_reaches: dict[Any, Reach] = {}
_addresses: dict[str, int] = {}
_taking: set[str] = set()  # keys of what takes the interpreter
_is_announced = True  # that something is compiled, in a line for each


def call(address: int, first: int, second: int, third: int, fourth: int) -> int:
    """Call a C function that takes up to four pointers or integers; the result is the status that it returns.

    By its address, from compiled code and from plain Python alike.
    """
    status: int = FUNCTION(address)(first, second, third, fourth)
    return status


def function_address(
    name: str, text: str, names: dict[str, Any], look_at: Callable[[Reach], None] = lambda _: None
) -> int:
    """The address of the C function `step` of a text that uses these names: loaded from disk, or compiled first.

    Before it is compiled, `look_at` may refuse what the text reaches. A process waits while another one compiles it.
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


def reach_of(text: str, names: dict[str, Any]) -> Reach:
    """Everything that the compiled form of a text depends on; looked for anew only where something has changed."""
    of = (text, *names, *names.values())
    if of not in _reaches or not _reaches[of].holds:
        _reaches[of] = Reach(*of)
    return _reaches[of]


def key_of(name: str, text: str, names: dict[str, Any]) -> str:
    """The name, and digits that change with everything that the compiled form of a text depends on."""
    return f"{name}_{reach_of(text, names).digits[:_DIGITS]}"


def kept_file(key: str, what: str) -> Path:
    """The file in which something made of a text is kept, for this processor and this compiler."""
    return cache_folder() / f"{key}.{_machine()}.{what}"


@cache
def _machine() -> str:
    from llvmlite import binding

    features = binding.get_host_cpu_features().flatten()
    settings = [os.environ.get(name, "") for name in _SETTINGS]
    known = (binding.get_host_cpu_name(), features, *settings, sys.version, *map(version, _MAKERS))
    digest = hashlib.sha256("\0".join(known).encode())
    for name in _TELLING:
        digest.update(Path(__file__).with_name(f"{name}.py").read_bytes())
    return digest.hexdigest()[:_DIGITS]


def keep(key: str, symbol: str, code: bytes) -> None:
    """Keep an object file and the name of its function."""
    write_checked(kept_file(key, _CODE), symbol.encode() + b"\n" + code)
    forget_older(key)


def kept_code(key: str) -> tuple[str, bytes] | None:
    """The name of the function and its object file, as `keep` was given them; None if nothing is kept."""
    kept = read_checked(kept_file(key, _CODE))
    if kept is None:
        return None
    symbol, _, code = kept.partition(b"\n")
    return symbol.decode(), code


def can_be_kept() -> bool:
    """Whether machine code is kept at all (EV_STACK_PLAIN_NUMBA)."""
    return "object_code" not in inside_numba.switched_off()


class Code(NamedTuple):
    """A text whose function `step` is one of C, with its name and the names that it uses."""

    name: str
    text: str
    names: dict[str, Any]

    def is_kept(self) -> bool:
        """Whether its machine code is on disk, so that nobody has to wait for the compiler."""
        return kept_code(key_of(*self)) is not None

    def address(self) -> int:
        """The address of the function, which is compiled where it is not kept."""
        return function_address(*self)


def forget_older(key: str) -> None:
    """Delete what older texts of the same name were compiled to, but for those that were compiled last."""
    folder, name = cache_folder(), key.rpartition("_")[0]
    newest = sorted(folder.glob(f"{name}_{'[0-9a-f]' * _DIGITS}.*"), key=age)
    texts = list(dict.fromkeys(file.name.partition(".")[0] for file in newest))
    for file in newest:
        if file.name.partition(".")[0] in texts[_KEPT_TEXTS:]:
            file.unlink(missing_ok=True)


def age(file: Path) -> float:
    """Rises with the time since a file or folder was written; 0 if it has gone."""
    try:
        return -file.stat().st_mtime
    except FileNotFoundError:  # another process has deleted it
        return 0.0


@cache
def _make_known() -> None:
    """Tell the compiler of `call` and of working memory."""
    from llvmlite import ir
    from numba import types
    from numba.extending import intrinsic, overload

    def called(typing: Any, address: Any, first: Any, second: Any, third: Any, fourth: Any) -> Any:
        def lowered(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            pointer = ir.IntType(8).as_pointer()
            function = builder.inttoptr(arguments[0], ir.FunctionType(ir.IntType(32), [pointer] * 4).as_pointer())
            return builder.call(function, [builder.inttoptr(word, pointer) for word in arguments[1:]])

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
    """Make all functions that are marked as compilable so far known to the compiler.

    It keeps what it has made of each of them, and forgets that where one is not what it was. Sums keep the order in
    which they are written (no fastmath), so results are the same to the bit in every run.
    """
    global _registered, _reached
    from numba.extending import register_jitable

    _make_known()
    if not _reached.holds:
        inside_numba.forget_made_of(FUNCTIONS[:_registered])
    elif _registered == len(FUNCTIONS):
        return
    while _registered < len(FUNCTIONS):
        function = FUNCTIONS[_registered]
        options = {"error_model": inside_numba_checks.error_model(), "forceinline": function in INLINED}
        register_jitable(no_cfunc_wrapper=True, **options)(function)
        _registered += 1
    _reached = Reach(*FUNCTIONS)


def made_by_others(text: str, names: dict[str, Any]) -> list[Any]:
    """What numba has made of functions that a text reaches (njit, ...), callees first."""
    return sorted(reach_of(text, names).made, key=lambda each: len(Reach(each).functions))


def _keep(function: Any, key: str, reach: Reach) -> None:
    def file(kinds: str) -> Path:
        return kept_file(key, f"{hashlib.sha256(kinds.encode()).hexdigest()[:12]}.numba")

    def read(kinds: str) -> bytes | None:
        kept = read_checked(file(kinds))
        if kept is None:
            _say_compiling(key)
        return kept

    def write(kinds: str, made: bytes) -> None:
        if reach.holds:  # and has not changed on the way
            write_checked(file(kinds), made)
            forget_older(key)

    inside_numba_code.keep_overloads(function, register_functions, lambda: alone(key), read, write)


def compiled_address(key: str, text: str, names: dict[str, Any]) -> int:
    """The address of the C function `step` of a text, compiled now and kept for who loads it without the compiler.

    Code that holds addresses of this process is not kept: another one would jump to where nothing is. TakesInterpreter
    if it cannot be called like this.
    """
    _say_compiling(key)
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
    """The function `step` of a text that uses these names, compiled or loaded with its first call."""
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
    sys.modules[module.__name__] = module  # what numba loads from disk asks for its module by name
    file = f"<{key}>"
    linecache.cache[file] = (len(text), None, text.splitlines(keepends=True), file)  # for what the compiler refuses
    exec(compile(text, file, "exec"), vars(module))
    return vars(module)["step"]


@contextmanager
def counted_by_others() -> Iterator[None]:
    """In the block no line says what is compiled: who has asked for it counts."""
    global _is_announced
    before, _is_announced = _is_announced, False
    try:
        yield
    finally:
        _is_announced = before


def _say_compiling(key: str) -> None:
    if _is_announced:
        name = key.rpartition("_")[0].replace("_", " ")
        print(f"compiling {name} ... (once)", file=sys.stderr, flush=True)
