"""The compiler: functions made once, kept on disk, and loaded again by later processes."""

from __future__ import annotations

import importlib.util
import sys
from typing import Any

import numba
from llvmlite.binding import ObjectFileRef
from numba.core.errors import TypingError
from numba.extending import register_jitable

from ev_msgs_py.compiling import foreign_calls, stack_memory  # noqa: F401, what `call` and `working_memory` are
from ev_msgs_py.compiling.callees import only_machine_code_of
from ev_msgs_py.compiling.compilable import FUNCTIONS, INLINED
from ev_msgs_py.compiling.machine_code import cache_folder, calls, code_file, forget_older, keep, text_file, write_whole

# Division by zero gives infinity as in numpy, without a test at each division; sums keep the order in which they are
# written (no fastmath), so results are the same to the bit in every run.
OPTIONS: dict[str, Any] = {"error_model": "numpy"}

_registered = 0


def register_functions() -> None:
    """Make all functions that are marked as compilable so far known to the compiler."""
    global _registered
    while _registered < len(FUNCTIONS):
        function = FUNCTIONS[_registered]
        register_jitable(**OPTIONS, no_cfunc_wrapper=True, forceinline=function in INLINED)(function)
        _registered += 1


def use_cache() -> None:
    """Let numba keep what it compiles in our folder, unless the user says where."""
    settings: Any = numba.config
    if not settings.CACHE_DIR:
        settings.CACHE_DIR = str(cache_folder())


def compiled_address(name: str, text: str, names: dict[str, Any]) -> int:
    """The address of the C function `step` of a text, compiled now and kept for who loads it without the compiler."""
    step = compiled_function(name, text, names)
    found = step._cache  # where numba keeps the object file, too
    data = found._cache_file.load(found._index_key(step._sig, step._library.codegen))
    code: bytes = data[0][2][0]
    # Code that takes memory from numba's heap needs numba itself.
    if not any(name.startswith("NRT_") and "alloc" in name for name in calls(ObjectFileRef.from_data(code))):
        keep(code_file(text_file(name, text, names)), step.native_name, code)
    address: int = step.address
    return address


def compiled_function(name: str, text: str, names: dict[str, Any]) -> Any:
    """The C function `step` of a text that uses these names; as a file, because numba keeps compiled code by file."""
    use_cache()
    file = text_file(name, text, names)
    if not file.exists():
        print(f"compiling {name.replace('_', ' ')} ... (once)", file=sys.stderr, flush=True)
        write_whole(file, text.encode())
        forget_older(file)
    spec: Any = importlib.util.spec_from_file_location(f"ev_stack_{file.stem}", file)
    module = importlib.util.module_from_spec(spec)
    vars(module).update(names)
    sys.modules[spec.name] = module  # what numba loads from disk asks for its module by name
    with only_machine_code_of("step"):
        try:
            spec.loader.exec_module(module)  # what is on disk needs no functions to be known, which takes a while
        except TypingError:
            register_functions()
            spec.loader.exec_module(module)
    return module.step
