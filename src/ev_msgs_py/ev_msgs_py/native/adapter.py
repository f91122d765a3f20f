"""The compiled step between the frames of the loop and a law in a library: it copies numbers and calls by address."""

from __future__ import annotations

from functools import cache

import numpy as np

from ev_msgs_py.compiling.foreign import call
from ev_msgs_py.compiling.machine_code import function_address
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.roles import ROLES
from ev_msgs_py.contract.signals import Instant
from ev_msgs_py.native.method import INPUTS, STATUS, NativeLaw

_TEXT = '''"""{role} in a library: generated, do not edit."""

from numba import carray, cfunc, types

P = types.voidptr


@cfunc(types.int32(P, P, P, P), error_model="numpy")
def step(now, next, state, constants):
    here, there = carray(now, {size}, FLOAT), carray(next, {size}, FLOAT)
    row, words, memory = carray(constants, {row}, FLOAT), carray(constants, 1, INT), carray(state, 1, FLOAT)
{copying}
    at = row.ctypes.data
    status = call(words[0], at + {inputs}, at + {outputs}, memory.ctypes.data, at + {given})
    row[{status}] = status
{writing}
    return status
'''


def adapter_address(law: NativeLaw) -> int:
    """Of the compiled step of a law, which is the same for all laws of a role that read the same signals."""
    return _compiled(law.library.role, law.library.reads, tuple(law.places.items()), law.outputs, law.given)


@cache
def _compiled(
    role: str, reads: tuple[type, ...], places: tuple[tuple[type, int], ...], outputs: int, given: int
) -> int:
    row = dict(places)
    (said,) = ROLES[role].writes
    copying = [f"row[{row[Instant]}] = here[{frame.TIME}]"]
    for signal in reads:
        copying += [f"row[{row[signal] + i}] = here[{at}]" for i, at in enumerate(frame.places(signal))]
    writing = [f"there[{at}] = row[{outputs + i}]" for i, at in enumerate(frame.places(said))]
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
    )
    return function_address(f"library_{role}", text, {"FLOAT": np.float64, "INT": np.int64, "call": call})
