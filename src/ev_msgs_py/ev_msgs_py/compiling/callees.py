"""Functions that only compiled functions call: they become machine code within their callers alone.

numba makes each of them machine code of its own as well, for callers in Python, which takes a third of the whole time,
and optimises what is inlined again at every level.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from numba.core.codegen import JITCodeLibrary
from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import cpu_target

from ev_msgs_py.compiling.compilable import INLINED


class _Callee(JITCodeLibrary):
    """Optimised, and complete as what it is linked into takes it."""

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True


class _Inlined(_Callee):
    """Left as it is: whoever takes it in optimises it there."""

    def _optimize_final_module(self) -> None:
        pass


@contextmanager
def only_machine_code_of(name: str) -> Iterator[None]:
    """What is compiled within becomes machine code if its function has this name, else nobody can call it in Python."""
    codegen: Any = cpu_target.target_context.codegen()
    engine, create_library, set_env = codegen._engine, codegen.create_library, codegen.set_env
    inlined = {function.__qualname__ for function in INLINED}

    def library_of(function: str, **options: Any) -> Any:
        if function == name:
            return create_library(function, **options)
        return (_Inlined if function in inlined else _Callee)(codegen, function, **options)

    def set_environment(symbol: str, environment: Any) -> None:
        if engine.is_symbol_defined(symbol):  # of machine code
            set_env(symbol, environment)

    with global_compiler_lock:
        codegen.create_library, codegen.set_env = library_of, set_environment
        try:
            yield
        finally:
            del codegen.create_library, codegen.set_env
