"""The records that `steps.take_steps` is told of and tells by, and its machine code as a C function."""

from __future__ import annotations

from functools import cache

import numpy as np

from ev_core.compiling import machine_code
from ev_core.lockstep.tally import BLOCK
from ev_core.lockstep.tally import address as tally_address
from ev_core.node_loop.message_memory import RUN, TOPIC, Memory, integers
from ev_core.node_loop.steps import take_steps

HEAD = np.dtype(
    [
        *integers("inputs", "outputs", "runs", "senders", "width", "size"),  # how many there are
        *integers("due", "run", "period", "limit", "integrates", "row", "until", "patience"),  # stamps and times in ns
        *integers("taken", "said", "spoke", "odd"),  # steps, the row of the last answer, when it was given; an input
        *integers("function", "state", "constants", "begin", "end"),  # of the part
        *integers("rcl_take", "rcl_publish", "rcl_count", "rcl_clear", "rcl_add", "rcl_add_guard"),  # addresses
        *integers("rcl_wait", "clock_gettime", "memcpy", "wait_set", "guard"),
        *integers("message", "info", "clock", "count"),  # words of the memory which these functions fill in
        *integers("heard"),  # byte of the memory to which the message is copied
        *integers("tallied", "taken_topics"),  # topics whose numbers are added up, and how many of them are inputs
    ]
)
INPUT = np.dtype([*TOPIC, *integers("subscription", "followed", "came", "came_next", "refused")])
OUTPUT = np.dtype([*TOPIC, *integers("publisher", "message")])

_TEXT = f'''"""The ordinary steps of nodes: generated, do not edit."""

import numpy as np
from numba import carray, cfunc, types

P = types.voidptr


@cfunc(types.int32(P, P, P, P, P, P, P, P), error_model="numpy")
def step(head, inputs, outputs, runs, senders, frames, block, tally):
    h = carray(head, 1, HEAD)[0]
    memory = Memory(
        carray(block, h.size, np.uint8),
        carray(block, h.size // 8, np.int64),
        carray(block, h.size // 4, np.int32),
        carray(block, h.size // 8, np.float64),
        carray(block, h.size // 4, np.float32),
    )
    return take_steps(
        h,
        carray(inputs, h.inputs, INPUT),
        carray(outputs, h.outputs, OUTPUT),
        carray(runs, h.runs, RUN),
        carray(senders, (h.inputs, h.senders, 2), np.int64),
        carray(frames, (4, h.width), np.float64),
        memory,
        carray(tally, {BLOCK}, np.int64),
    )
'''
_NAMES = {"HEAD": HEAD, "INPUT": INPUT, "OUTPUT": OUTPUT, "RUN": RUN, "Memory": Memory, "take_steps": take_steps}


def is_kept() -> bool:
    """Whether the machine code is on disk, so that nobody has to wait for the compiler."""
    return machine_code.is_kept("node_steps", _TEXT, _NAMES)


def keep() -> None:
    """See to it that the machine code is on disk: nodes go without it rather than wait, at half the speed."""
    if not is_kept():
        address()
    tally_address()


@cache
def address() -> int:
    """Of the loop as a C function."""
    return machine_code.function_address("node_steps", _TEXT, _NAMES)
