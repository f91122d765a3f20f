"""All that touches the inside of numba: callees, calls by address, memory on the stack.

Functions that only compiled functions call: they become machine code within their callers alone.
numba makes each of them machine code of its own as well, for callers in Python, which takes a third of the whole time,
and optimises what is inlined again at every level.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import cpu_target
from numba.extending import lower_builtin, type_callable
from numba.np.arrayobj import make_array, populate_array

from ev_core.compiling.foreign import call
from ev_core.parameters.record import working_memory
from ev_msgs_py.compilable import INLINED


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


@type_callable(call)
def _type(context: Any) -> Any:
    def typer(address: Any, first: Any, second: Any, third: Any, fourth: Any) -> Any:
        return types.int32

    return typer


@lower_builtin(call, *[types.Integer] * 5)
def _lowered(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    pointer = ir.IntType(8).as_pointer()
    words = [
        context.cast(builder, each, kind, types.intp) for each, kind in zip(arguments, signature.args, strict=True)
    ]
    function = builder.inttoptr(words[0], ir.FunctionType(ir.IntType(32), [pointer] * 4).as_pointer())
    return builder.call(function, [builder.inttoptr(word, pointer) for word in words[1:]])


@type_callable(working_memory)
def _type_of_memory(context: Any) -> Any:
    def typer(layout: Any) -> Any:
        return types.Array(layout.dtype, 1, "C") if isinstance(layout, types.DType) else None

    return typer


@lower_builtin(working_memory, types.DType)
def _lowered_memory(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    kind = signature.return_type
    size = context.get_constant(types.intp, kind.dtype.size)
    data = cgutils.alloca_once(builder, context.get_data_type(kind.dtype))
    data.align = 64
    cgutils.memset(builder, data, size, 0)
    array = make_array(kind)(context, builder)
    one = context.get_constant(types.intp, 1)
    populate_array(array, data=data, shape=[one], strides=[size], itemsize=size, meminfo=None)
    return array._getvalue()
