"""`contract.record.working_memory` in compiled code: on the stack, because the heap costs as much as a wheel."""

from __future__ import annotations

from typing import Any

from numba import types
from numba.core import cgutils
from numba.extending import lower_builtin, type_callable
from numba.np.arrayobj import make_array, populate_array

from ev_msgs_py.contract.record import working_memory


@type_callable(working_memory)
def _type(context: Any) -> Any:
    def typer(layout: Any) -> Any:
        return types.Array(layout.dtype, 1, "C") if isinstance(layout, types.DType) else None

    return typer


@lower_builtin(working_memory, types.DType)
def _lowered(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    kind = signature.return_type
    size = context.get_constant(types.intp, kind.dtype.size)
    data = cgutils.alloca_once(builder, context.get_data_type(kind.dtype))
    data.align = 64
    cgutils.memset(builder, data, size, 0)
    array = make_array(kind)(context, builder)
    one = context.get_constant(types.intp, 1)
    populate_array(array, data=data, shape=[one], strides=[size], itemsize=size, meminfo=None)
    return array._getvalue()
