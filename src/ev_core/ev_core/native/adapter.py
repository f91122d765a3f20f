"""The compiled step between the frame and a law of a shared library."""

from __future__ import annotations

from functools import cache

import numpy as np

from ev_core.compiling.machine_code import call, function_address
from ev_core.methods.part import without_sign
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.fields import NEGLIGIBLE, shape_of
from ev_msgs_py.contract.roles import ROLES
from ev_msgs_py.contract.signals import Instant

# place of what the last step returned; before it stands the address of the function, behind it the
# inputs
STATUS = 1
INPUTS = 2

_TEXT = '''"""{role} in a library: generated, do not edit."""

from numba import carray, cfunc, types

P = types.voidptr


@cfunc(types.int32(P, P, P, P), error_model="numpy")
def step(now, next, state, constants):
    here, there = carray(now, {size}, FLOAT), carray(next, {size}, FLOAT)
    row, words = carray(constants, {row}, FLOAT), carray(constants, 1, INT)
    memory = carray(state, 1, FLOAT)
{copying}
    at = row.ctypes.data
    status = call(words[0], at + {inputs}, at + {outputs}, memory.ctypes.data, at + {given})
    row[{status}] = status
{writing}
    return 1 if status == 0 and ({negative}) else status
'''


@cache
def adapter(
    role: str,
    reads: tuple[type, ...],
    places: tuple[tuple[type, int], ...],
    outputs: int,
    given: int,
) -> int:
    """Address of the compiled step between frame and library.

    It is the same for all laws of a role that read the same.
    """
    row = dict(places)
    (written,) = ROLES[role].writes
    copying = [f"row[{row[Instant]}] = here[{frame.TIME}]"]
    for signal in reads:
        copying += [
            f"row[{row[signal] + i}] = here[{at}]" for i, at in enumerate(frame.places(signal))
        ]
    writing = [f"there[{at}] = row[{outputs + i}]" for i, at in enumerate(frame.places(written))]
    unsigned = shape_of(written).never_negative
    for i in unsigned:
        writing[i] = f"there[{frame.places(written)[i]}] = without_sign(row[{outputs + i}])"
    negative = " or ".join(f"row[{outputs + i}] < {-NEGLIGIBLE}" for i in unsigned) or "False"
    copying, writing = ([f"    {line}" for line in lines] for lines in (copying, writing))
    text = _TEXT.format(
        role=role,
        size=frame.SIZE,
        row=given,
        copying="\n".join(copying),
        writing="\n".join(writing),
        inputs=8 * INPUTS,
        outputs=8 * outputs,
        given=8 * given,
        status=STATUS,
        negative=negative,
    )
    names = {"FLOAT": np.float64, "INT": np.int64, "call": call, "without_sign": without_sign}
    return function_address(f"library_{role}", text, names)
