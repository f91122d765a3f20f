"""The ordinary steps of a node in lockstep as one compiled loop: messages in, a step, messages out, sleep.

Ordinary is a message from the one who may speak, laid out as our nodes do, finite, and of the step that is due. Whatever
else comes ends the loop and is for Python to judge (`lockstep/inbox.py`). `nodes/ordinary_steps.py` lays out the memory.
"""

from __future__ import annotations

from functools import cache
from time import CLOCK_MONOTONIC
from typing import Any

import numpy as np

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.compiling.foreign import call
from ev_msgs_py.compiling.machine_code import code_file, function_address, text_file
from ev_msgs_py.contract.frame import TIME
from ev_msgs_py.contract.stamps import NANOSECONDS
from ev_msgs_py.wire.message_format import STAMP_AT

# Why the loop has ended: nothing came in time; a message is for Python to judge; the last step that may be taken was
# taken; the part has failed, or has written what is not finite.
IDLE, ODD, LIMIT, FAILED, NOT_FINITE = range(5)
_NOTHING, _KEPT, _REFUSED = range(-3, 0)  # what else there can be to a message

_AT_ONCE = 100  # messages of one input that are taken between two looks at the others


def _integers(*names: str) -> np.dtype:
    return np.dtype([(name, np.int64) for name in names])


# Stamps and times in nanoseconds. `rcl_...`, `clock_gettime`, `memcpy` and `function` are addresses of functions;
# `message`, `info`, `clock`, `count` are words of the memory, which they fill in; at the byte `heard` a message is copied.
HEAD = np.dtype(
    [
        *_integers("inputs", "outputs", "runs", "senders", "width", "size").descr,  # of what is handed over
        *_integers("due", "period", "limit", "integrates", "row", "until", "patience").descr,
        *_integers("taken", "said", "spoke", "odd").descr,  # what the loop tells
        *_integers("function", "state", "constants", "begin", "end").descr,  # of the part
        *_integers("rcl_take", "rcl_publish", "rcl_count", "rcl_clear", "rcl_add", "rcl_wait").descr,
        *_integers("clock_gettime", "memcpy", "wait_set", "message", "info", "clock", "count", "heard").descr,
    ]
)
# `template` and `mask`, which has all bits of what is constant, are bytes of the memory; `first` and `last` count runs.
INPUT = np.dtype(
    [
        *_integers("subscription", "length", "template", "mask", "first", "last", "single", "followed").descr,
        *_integers("came", "came_next", "refused").descr,
    ]
)
OUTPUT = _integers("publisher", "message", "template", "first", "last", "single")
RUN = _integers("place", "offset", "length")
GID = 5  # word of the message's information at which the identity of its publisher begins, of two words


@compilable
def take_steps(head, inputs, outputs, runs, senders, frames, memory, words, doubles, singles, integers):
    """Take steps until there is a reason to stop, which is returned.

    `frames` has four rows: the inputs of two steps, which take turns in being due, and what is said to them. `memory` is
    one, as bytes and as numbers of 8 and 4 bytes. Of `senders` (inputs, n, 2) the first may speak, the others may not.
    """
    while True:
        came = False
        for i in range(len(inputs)):
            for _ in range(_AT_ONCE):
                if not _is_missing(inputs[i]):
                    break
                found = _take(head, inputs[i], senders[i], runs, frames, memory, words, doubles, singles, integers)
                if found == ODD:
                    head.odd = i
                    return ODD
                if found == _NOTHING:
                    break
                came = came or found == _KEPT
        if _is_complete(inputs):
            if head.due > head.limit:
                return LIMIT
            failure = _step(head, inputs, frames)
            if failure:
                return failure
            _speak(head, outputs, runs, frames, words, doubles, singles, integers)
        elif not came and not _sleep(head, inputs, words):
            return IDLE


@compilable
def _is_missing(one):
    return one.came == 0 or (one.followed != 0 and one.came_next == 0)


@compilable
def _is_complete(inputs):
    for i in range(len(inputs)):
        if _is_missing(inputs[i]):
            return False
    return True


@compilable
def _take(head, one, senders, runs, frames, memory, words, doubles, singles, integers):
    """Take the next message of an input, and keep its numbers if it is an ordinary one."""
    here = words.ctypes.data
    if call(head.rcl_take, one.subscription, here + 8 * head.message, here + 8 * head.info, 0) != 0:
        return _NOTHING
    low, high = words[head.info + GID], words[head.info + GID + 1]
    if low != senders[0, 0] or high != senders[0, 1]:
        for k in range(1, len(senders)):
            if low == senders[k, 0] and high == senders[k, 1]:
                one.refused += 1
                return _REFUSED
        return ODD
    buffer, length = words[head.message], words[head.message + 1]
    if length != one.length:
        return ODD
    call(head.memcpy, here + head.heard, buffer, length, 0)
    differs = 0
    for n in range(length):
        differs |= (memory[head.heard + n] ^ memory[one.template + n]) & memory[one.mask + n]
    at = (head.heard + STAMP_AT) // 4
    stamp = integers[at] * NANOSECONDS + integers[at + 1]
    is_next = stamp == head.due + head.period and one.followed != 0 and one.came_next == 0
    if differs or not (is_next or (stamp == head.due and one.came == 0)):
        return ODD
    row = 1 - head.row if is_next else head.row
    for r in range(one.first, one.last):
        place, at = runs[r].place, head.heard + runs[r].offset
        for n in range(runs[r].length):
            value = float(singles[at // 4 + n]) if one.single else doubles[at // 8 + n]
            if value - value != 0.0:
                return ODD
            frames[row, place + n] = value
    if is_next:
        one.came_next = 1
    else:
        one.came = 1
    return _KEPT


@compilable
def _step(head, inputs, frames):
    """One step of the part; what it says stands in the row of the inputs or, if it integrates, two rows behind."""
    said = head.row + 2 if head.integrates else head.row
    head.said = said
    frames[head.row, TIME] = head.due / NANOSECONDS
    if head.integrates:
        frames[said, TIME] = (head.due + head.period) / NANOSECONDS
    first, width = frames.ctypes.data, 8 * frames.shape[1]
    if call(head.function, first + head.row * width, first + said * width, head.state, head.constants) != 0:
        return FAILED
    for n in range(head.begin, head.end):
        if frames[said, n] - frames[said, n] != 0.0:
            return NOT_FINITE
    for i in range(len(inputs)):
        inputs[i].came, inputs[i].came_next = inputs[i].came_next, 0
    head.due += head.period
    head.row = 1 - head.row
    head.taken += 1
    return 0


@compilable
def _speak(head, outputs, runs, frames, words, doubles, singles, integers):
    """Publish what the last step has said, as far as somebody hears it."""
    stamp = head.due if head.integrates else head.due - head.period
    row = head.said
    here = words.ctypes.data
    for i in range(len(outputs)):
        one = outputs[i]
        call(head.rcl_count, one.publisher, here + 8 * head.count, 0, 0)
        if words[head.count] == 0:
            continue
        at = (one.template + STAMP_AT) // 4
        integers[at], integers[at + 1] = stamp // NANOSECONDS, stamp % NANOSECONDS
        for r in range(one.first, one.last):
            place, at = runs[r].place, one.template + runs[r].offset
            for n in range(runs[r].length):
                if one.single:
                    singles[at // 4 + n] = frames[row, place + n]
                else:
                    doubles[at // 8 + n] = frames[row, place + n]
        call(head.rcl_publish, one.publisher, here + 8 * one.message, 0, 0)
    head.spoke = _wall_clock(head, words)


@compilable
def _sleep(head, inputs, words):
    """Sleep until the last input that is missing comes; False if nothing has come in time."""
    left = min(head.patience, head.until - _wall_clock(head, words))
    if left <= 0:
        return False
    last = 0
    for i in range(len(inputs)):
        if _is_missing(inputs[i]):
            last = i
    call(head.rcl_clear, head.wait_set, 0, 0, 0)
    call(head.rcl_add, head.wait_set, inputs[last].subscription, 0, 0)
    return call(head.rcl_wait, head.wait_set, left, 0, 0) == 0


@compilable
def _wall_clock(head, words):
    """The monotonic clock, as time.monotonic_ns."""
    call(head.clock_gettime, CLOCK_MONOTONIC, words.ctypes.data + 8 * head.clock, 0, 0)
    return words[head.clock] * NANOSECONDS + words[head.clock + 1]


_TEXT = '''"""The ordinary steps of nodes: generated, do not edit."""

import numpy as np
from numba import carray, cfunc, types

P = types.voidptr


@cfunc(types.int32(P, P, P, P, P, P, P), cache=True, error_model="numpy")
def step(head, inputs, outputs, runs, senders, frames, memory):
    h = carray(head, 1, HEAD)[0]
    return take_steps(
        h,
        carray(inputs, h.inputs, INPUT),
        carray(outputs, h.outputs, OUTPUT),
        carray(runs, h.runs, RUN),
        carray(senders, (h.inputs, h.senders, 2), np.int64),
        carray(frames, (4, h.width), np.float64),
        carray(memory, h.size, np.uint8),
        carray(memory, h.size // 8, np.int64),
        carray(memory, h.size // 8, np.float64),
        carray(memory, h.size // 4, np.float32),
        carray(memory, h.size // 4, np.int32),
    )
'''
_NAMES: dict[str, Any] = {"HEAD": HEAD, "INPUT": INPUT, "OUTPUT": OUTPUT, "RUN": RUN, "take_steps": take_steps}


def is_kept() -> bool:
    """Whether the machine code is on disk, so that nobody has to wait for the compiler."""
    return code_file(text_file(*_TEXT_AND_NAMES)).exists()


@cache
def address() -> int:
    """Of the loop as a C function."""
    return function_address(*_TEXT_AND_NAMES)


_TEXT_AND_NAMES = ("node_steps", _TEXT, _NAMES)
