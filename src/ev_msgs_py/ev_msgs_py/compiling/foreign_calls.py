"""`compiling.foreign.call` in compiled code: a call, without Python."""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import lower_builtin, type_callable

from ev_msgs_py.compiling.foreign import call


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
