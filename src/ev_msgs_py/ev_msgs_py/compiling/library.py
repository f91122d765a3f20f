"""Compiled parts by method: made once, kept on disk, and loaded again by later processes."""

from __future__ import annotations

import importlib.util
import os
import sys
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

import numba
from numba.core.errors import TypingError
from numba.extending import register_jitable

from ev_msgs_py.compiling import stack_memory  # noqa: F401, tells the compiler what `working_memory` is
from ev_msgs_py.compiling.compilable import FUNCTIONS, INLINED
from ev_msgs_py.compiling.fingerprint import fingerprint
from ev_msgs_py.compiling.part_source import part_source
from ev_msgs_py.lockstep.law import Given
from ev_msgs_py.lockstep.methods import Method

# Division by zero gives infinity as in numpy, without a test at each division; sums keep the order in which they are
# written (no fastmath), so results are the same to the bit in every run.
OPTIONS: dict[str, Any] = {"error_model": "numpy"}

_registered = 0


def register_functions() -> None:
    """Make all functions that are marked as compilable so far known to the compiler."""
    global _registered
    while _registered < len(FUNCTIONS):
        function = FUNCTIONS[_registered]
        register_jitable(**OPTIONS, forceinline=function in INLINED)(function)
        _registered += 1


@cache
def cache_folder() -> Path:
    """Where compiled code is kept: where EV_STACK_CACHE says, beside the package, or where the user may write."""
    beside = Path(__file__).parents[1] / "__pycache__" / "compiled"
    own = Path(tempfile.gettempdir()) / f"ev_stack-{os.getuid()}" / "compiled"
    for folder in (Path(os.environ.get("EV_STACK_CACHE") or beside), beside, own):
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError:
            continue
        if os.access(folder, os.W_OK):
            return folder
    return Path(tempfile.mkdtemp(prefix="ev_stack-"))


def use_cache() -> None:
    """Let numba keep what it compiles in our folder, unless the user says where."""
    if not numba.config.CACHE_DIR:
        numba.config.CACHE_DIR = str(cache_folder())


_PARTS: dict[Any, Any] = {}


def compiled_part(method: Method, given: Given) -> int:
    """The address of the compiled part of a method (`part_source`); `given` is that of any of its objects."""
    law = method.law
    key = (law.function, law.outputs)
    if key not in _PARTS:
        _PARTS[key] = compiled_function(f"{method.name}_{method.role}", *part_source(method, given))
    return _PARTS[key].address


def compiled_function(name: str, text: str, names: dict[str, Any]) -> Any:
    """The C function `step` of a text that uses these names; as a file, because numba keeps compiled code by file."""
    use_cache()
    digest = fingerprint(text, *names.values())[:12]
    file = cache_folder() / f"{name}_{digest}.py"
    if not file.exists():
        print(f"compiling {name.replace('_', ' ')} ... (once)", file=sys.stderr, flush=True)
        unfinished = file.with_name(f".{file.name}.{os.getpid()}")
        unfinished.write_text(text)
        unfinished.replace(file)
    spec = importlib.util.spec_from_file_location(f"ev_stack_{file.stem}", file)
    module = importlib.util.module_from_spec(spec)
    vars(module).update(names)
    sys.modules[spec.name] = module  # what numba loads from disk asks for its module by name
    try:
        spec.loader.exec_module(module)  # what is on disk needs no functions to be known, which takes a while
    except TypingError:
        register_functions()
        spec.loader.exec_module(module)
    return module.step
