"""Touches of numba's inside that keep code on disk and load it, as those in `inside_numba`."""

from __future__ import annotations

import builtins
import importlib.util
import pickle
import re
import sys
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from importlib.machinery import PathFinder
from pathlib import Path
from typing import Any

from ev_core.compiling.inside_numba import is_used, switched_off
from ev_core.compiling.object_symbols import calls

# overloads: what numba makes of functions that Python calls is kept in files of ours. Plain: each
# process makes it.

# Modules of numba with what compiled code may call, and how their functions are named there.
_HELPERS = {"numba._helperlib": "numba_", "numba.core.runtime._nrt_python": "NRT_"}
# In the compiler's text a call by which a function takes the interpreter, and the marks of one that
# only an error leads to: C functions report exceptions, a C function that is called may have no
# address, a library may be missing.
_TAKEN = re.compile(r"\bcall [^\n]*@numba_gil_ensure\(")
_ONLY_OF_ERRORS = re.compile(
    r"^define [^\n]*@cfunc\.|\bcall [^\n]*(?:_get_wrapper_address\)|@Py_FatalError\()", re.M
)


def keep_overloads(
    function: Any,
    ready: Callable[[], None],
    alone: Callable[[], AbstractContextManager[None]],
    read: Callable[[str], bytes | None],
    write: Callable[[str, bytes], None],
) -> None:
    """Let numba, once `ready`, `read` and `write` what it has made of a function.

    It does so within `alone`, so that of several processes one compiles; addresses of this process
    are not written.
    """
    if not is_used("overloads"):
        return
    from numba.core.caching import NullCache
    from numba.core.compiler import CompileResult
    from numba.core.serialize import dumps

    class Kept(NullCache):
        def load_overload(self, signature: Sequence[Any], target: Any) -> Any:
            ready()
            target.refresh()
            kept = read(repr(_with_names(signature)))
            return None if kept is None else CompileResult._rebuild(target, *pickle.loads(kept))

        def save_overload(self, signature: Sequence[Any], made: Any) -> None:
            if not made.library.has_dynamic_globals:
                write(repr(_with_names(signature)), dumps(made._reduce()))

    def compiled(signature: Any) -> Any:
        with alone():
            return type(function).compile(function, signature)

    function._cache, function.compile = Kept(), compiled


def _with_names(kinds: Sequence[Any]) -> list[Any]:
    """Types with the names of what they hold, which numba does not show of a named tuple."""
    return [
        (kind, getattr(kind, "fields", ()), _with_names(getattr(kind, "types", ())))
        for kind in kinds
    ]


# object_code: machine code is taken out of numba, and loaded without it by llvmlite. Plain: each
# process compiles.


_engines: list[Any] = []  # what they have loaded lasts as long as they do


def object_code(function: Any) -> tuple[str, bytes] | None:
    """The name of a C function (`cfunc`) and its object file.

    None if that holds addresses of this process.
    """
    if not is_used("object_code") or function._library.has_dynamic_globals:
        return None
    return function.native_name, function._library._get_compiled_object()


def loaded(symbol: str, code: bytes) -> int:
    """The address of a function of an object file; 0 if its code calls what is not there."""
    if "object_code" in switched_off():
        return 0
    from llvmlite import binding

    binding.initialize_native_target()
    binding.initialize_native_asmprinter()
    machine = binding.Target.from_default_triple().create_target_machine()
    try:
        # before an engine makes other things known by the names of exceptions
        _name_helpers(binding)
    except (ImportError, AttributeError):  # of another numba
        return 0
    engine = binding.create_mcjit_compiler(binding.parse_assembly(""), machine)
    found = binding.ObjectFileRef.from_data(code)
    called = calls(code)
    if any(name.startswith("NRT_") and "alloc" in name for name in called):
        from numba.core.registry import cpu_target
        from numba.core.runtime.nrt import rtsys

        # the heap of numba, for which such code has to wait
        rtsys.initialize(cpu_target.target_context)
    if not all(map(binding.address_of_symbol, called)):
        return 0
    engine.add_object_file(found)
    engine.finalize_object()
    _engines.append(engine)
    address: int = engine.get_function_address(symbol)
    return address


def _name_helpers(binding: Any) -> None:
    """Name the functions that code may call besides the C library.

    Numba does so when it has compiled a function.
    """
    package: Any = importlib.util.find_spec("numba")
    numba = Path(package.submodule_search_locations[0])
    helpers = {
        f"PyExc_{name}": id(value)
        for name, value in vars(builtins).items()
        if isinstance(value, type)
    }
    for place, prefix in _HELPERS.items():
        folder, _, name = place.rpartition(".")
        module: Any = sys.modules.get(place)
        if module is None:
            spec: Any = PathFinder.find_spec(name, [str(numba.joinpath(*folder.split(".")[1:]))])
            module = importlib.util.module_from_spec(spec)
            spec.loader.exec_module(module)
        for helper, address in module.c_helpers.items():
            helpers[helper[1:] if helper.startswith("_") else prefix + helper] = address
    for name, address in helpers.items():
        if not binding.address_of_symbol(name):
            binding.add_symbol(name, address)


def takes_interpreter(step: Any) -> bool:
    """Return whether a C function or a callee needs the interpreter for an answer.

    Its compiled text shows it.
    """
    functions = step.inspect_llvm().split("\n}")
    return any(len(_TAKEN.findall(each)) > len(_ONLY_OF_ERRORS.findall(each)) for each in functions)
