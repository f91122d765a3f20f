"""The ordinary steps of a node in lockstep as one compiled loop: messages in, a step, messages out, sleep.

Ordinary is a message of the admitted publisher, laid out as our nodes do, its numbers finite and
none negative that must not be, and NEW by the protocol of `lockstep/inbox.py`, which is compiled
here and works on the memory of the node's inbox. Whatever else comes ends the loop and is for
Python to see to. Messages stand in a block of memory; how they are read and written there is the
compiled form of `wire`.
"""

from __future__ import annotations

from time import CLOCK_MONOTONIC
from typing import Any, NamedTuple

import numpy as np

from ev_core.compiling.machine_code import Code, call
from ev_core.lockstep.inbox import (
    LAST,
    NEW,
    ROWS,
    Steps,
    judged,
    keep,
    missing,
    note_answer,
    row_of,
    row_of_answer,
)
from ev_msgs_py.compilable import compilable
from ev_msgs_py.contract.frame import SIZE, TIME
from ev_msgs_py.contract.stamps import NANOSECONDS
from ev_msgs_py.wire import STAMP_AT
from ev_nodes.rcl.taking import GID

# Why the loop has ended: nothing came in time; a message is for Python to judge; the last step that
# may be taken was taken; the part has failed, or has written what is not finite.
IDLE, ODD, LIMIT, FAILED, NOT_FINITE = range(5)
_NOTHING, _KEPT = range(-2, 0)  # what else can become of a message
_AT_ONCE = 100  # messages of one input that are taken between two looks at the others
_TEXT = f'''"""The ordinary steps of nodes: generated, do not edit."""

import numpy as np
from numba import carray, cfunc, types

P = types.voidptr


@cfunc(types.int32(P, P, P, P, P, P, P, P), error_model="numpy")
def step(head, steps, inputs, outputs, runs, admitted, frames, block):
    h = carray(head, 1, LOOP)[0]
    s = carray(steps, {3 + 2 * ROWS}, np.int64)
    memory = Memory(
        carray(block, h.size, np.uint8),
        carray(block, h.size // 8, np.int64),
        carray(block, h.size // 4, np.int32),
        carray(block, h.size // 8, np.float64),
        carray(block, h.size // 4, np.float32),
    )
    return take_steps(
        Work(
            h,
            Steps(
                s[:3], s[3:{3 + ROWS}], s[{3 + ROWS}:], h.inputs, h.heralds, h.followed, h.period, h.lead, h.may_skip
            ),
            carray(inputs, h.topics, INPUT),
            carray(outputs, h.publishers, OUTPUT),
            carray(runs, h.runs, RUN),
            carray(admitted, (h.topics, 2), np.int64),
            carray(frames, ({ROWS + 2}, {SIZE}), np.float64),
            memory,
        )
    )
'''


class Memory(NamedTuple):
    """One block as bytes and as numbers.

    Messages are placed so that their numbers are whole ones of the block.
    """

    bytes: Any
    words: Any  # integers of 8 bytes
    integers: Any  # of 4 bytes
    doubles: Any
    singles: Any


class Work(NamedTuple):
    """Memory that one loop works on; `steps` and `frames` are those of the node's inbox.

    `admitted` (inputs, 2) is the identity of the publisher of an input.
    """

    head: Any
    steps: Steps
    inputs: Any
    outputs: Any
    runs: Any
    admitted: Any
    frames: Any
    memory: Memory


def integers(*names: str) -> list[Any]:
    """Fields of a record that are integers."""
    return [(name, np.int64) for name in names]


# A topic: `template` and `mask`, which has all bits of what is constant, begin at these bytes of
# the block, and the runs `first` to `last` have its numbers, which are `single` precision or not.
# Those of the frame from place `unsigned` on to `signed` are commands that are never negative.
TOPIC = integers("template", "mask", "length", "first", "last", "single", "unsigned", "signed")
RUN = np.dtype(integers("place", "offset", "length"))


@compilable
def is_laid_out_like(memory: Any, at: int, topic: Any) -> bool:
    """Return whether a message of the length of a topic's template has its constants."""
    differs = 0
    for n in range(topic.length):
        other = memory.bytes[at + n] ^ memory.bytes[topic.template + n]
        differs |= other & memory.bytes[topic.mask + n]
    return differs == 0


@compilable
def stamp_in(memory: Any, at: int) -> int:
    """The stamp of a message [ns]."""
    place = (at + STAMP_AT) // 4
    stamp: int = int(memory.integers[place]) * NANOSECONDS + int(memory.integers[place + 1])
    return stamp


@compilable
def read_numbers(memory: Any, at: int, topic: Any, runs: Any, numbers: Any) -> bool:
    """Copy the numbers of a message into a frame.

    False if one is not finite, or negative and must not be.
    """
    for r in range(topic.first, topic.last):
        place, begin = runs[r].place, at + runs[r].offset
        for n in range(runs[r].length):
            if topic.single:
                number = float(memory.singles[begin // 4 + n])
            else:
                number = memory.doubles[begin // 8 + n]
            if number - number != 0.0:
                return False
            numbers[place + n] = number
    negative = 0
    for place in range(topic.unsigned, topic.signed):
        negative += numbers[place] < 0.0
    return negative == 0


@compilable
def write_message(memory: Any, topic: Any, runs: Any, stamp: int, numbers: Any) -> None:
    """Put stamp and numbers of a frame into the template of a topic."""
    at = (topic.template + STAMP_AT) // 4
    memory.integers[at], memory.integers[at + 1] = stamp // NANOSECONDS, stamp % NANOSECONDS
    for r in range(topic.first, topic.last):
        place, begin = runs[r].place, topic.template + runs[r].offset
        for n in range(runs[r].length):
            if topic.single:
                memory.singles[begin // 4 + n] = numbers[place + n]
            else:
                memory.doubles[begin // 8 + n] = numbers[place + n]


@compilable
def take_steps(work: Work) -> int:
    """Take steps until there is a reason to stop, which is returned."""
    head, steps = work.head, work.steps
    while True:
        came = False
        for i in range(len(work.inputs)):
            for _ in range(_AT_ONCE):
                if missing(steps) >> i & 1 == 0:
                    break
                found = _take(work, i)
                if found == ODD:
                    head.odd = i
                    return ODD
                if found == _NOTHING:
                    break
                if found == _KEPT:
                    came, head.came = True, 1
        lacking = missing(steps)
        if lacking == 0:
            if steps.done[LAST] + steps.period > head.limit:
                return LIMIT
            failure = _step(work)
            if failure:
                return failure
            _publish(work)
        elif not came and not _sleep(work, _last_of(work.inputs, lacking).subscription):
            return IDLE


@compilable
def _last_of(inputs: Any, lacking: int) -> Any:
    """The input of the highest bit: the one that arrives last."""
    last = 0
    for i in range(len(inputs)):
        if lacking >> i & 1 != 0:
            last = i
    return inputs[last]


@compilable
def _take(work: Work, i: int) -> int:
    """Take the next message of an input, and keep its numbers if it is an ordinary one."""
    head, steps, memory = work.head, work.steps, work.memory
    one, admitted = work.inputs[i], work.admitted[i]
    here = memory.words.ctypes.data
    if call(head.rcl_take, one.subscription, here + 8 * head.message, here + 8 * head.info, 0) != 0:
        return _NOTHING
    # The publisher first: a foreign message is not looked at.
    low, high = memory.words[head.info + GID], memory.words[head.info + GID + 1]
    if low != admitted[0] or high != admitted[1]:
        return ODD
    buffer, length = memory.words[head.message], memory.words[head.message + 1]
    if length != one.length:
        return ODD
    call(head.memcpy, here + head.heard, buffer, length, 0)
    stamp = stamp_in(memory, head.heard)
    if judged(steps, stamp, i) != NEW or not is_laid_out_like(memory, head.heard, one):
        return ODD
    if not read_numbers(memory, head.heard, one, work.runs, work.frames[row_of(steps, stamp)]):
        return ODD
    keep(steps, stamp, i)
    return _KEPT


@compilable
def _step(work: Work) -> int:
    """Take one step of the part; FAILED or NOT_FINITE if it gives no answer, else 0."""
    head, steps, frames = work.head, work.steps, work.frames
    due = steps.done[LAST] + steps.period
    answered, number = due + steps.lead, due // steps.period
    row, output = row_of(steps, due), row_of_answer(steps, answered)
    frames[row, TIME] = number * steps.period / NANOSECONDS
    frames[output, TIME] = answered // steps.period * steps.period / NANOSECONDS
    first, width = frames.ctypes.data, 8 * frames.shape[1]
    now, answer = first + row * width, first + output * width
    if call(head.function, now, answer, head.state, head.constants) != 0:
        return FAILED
    for n in range(head.begin, head.end):
        if frames[output, n] - frames[output, n] != 0.0:
            return NOT_FINITE
    steps.done[LAST] = due
    note_answer(steps, answered)
    head.taken += 1
    return 0


@compilable
def _publish(work: Work) -> None:
    """Publish the last answer, as far as it has subscribers."""
    head, steps, outputs, memory = work.head, work.steps, work.outputs, work.memory
    stamp = steps.done[LAST] + steps.lead
    here = memory.words.ctypes.data
    for i in range(len(outputs)):
        call(head.rcl_count, outputs[i].publisher, here + 8 * head.count, 0, 0)
        if memory.words[head.count] != 0:
            write_message(
                memory, outputs[i], work.runs, stamp, work.frames[row_of_answer(steps, stamp)]
            )
            call(head.rcl_publish, outputs[i].publisher, here + 8 * outputs[i].message, 0, 0)
    head.spoke = _wall_clock(head, memory)


@compilable
def _sleep(work: Work, subscription: int) -> bool:
    """Sleep until a message comes; False if there is none in time."""
    head = work.head
    left = min(head.patience, head.until - _wall_clock(head, work.memory))
    if left <= 0:
        return False
    call(head.rcl_clear, head.wait_set, 0, 0, 0)
    call(head.rcl_add, head.wait_set, subscription, 0, 0)
    call(head.rcl_add_guard, head.wait_set, head.guard, 0, 0)
    return call(head.rcl_wait, head.wait_set, left, 0, 0) == 0


@compilable
def _wall_clock(head: Any, memory: Any) -> int:
    """The monotonic clock [ns]."""
    call(head.clock_gettime, CLOCK_MONOTONIC, memory.words.ctypes.data + 8 * head.clock, 0, 0)
    now: int = memory.words[head.clock] * NANOSECONDS + memory.words[head.clock + 1]
    return now


LOOP = np.dtype(
    [
        *integers("topics", "publishers", "runs", "size"),  # how many there are
        *integers("inputs", "heralds", "followed", "period", "lead", "may_skip"),  # as in `Steps`
        *integers("limit", "until", "patience"),  # a stamp, and times [ns]
        *integers("came"),  # 1 if a message was kept
        *integers("taken", "spoke", "odd"),  # steps, when the last answer was given, an input
        *integers("function", "state", "constants", "begin", "end"),  # of the part
        *integers("rcl_take", "rcl_publish", "rcl_count"),  # addresses
        *integers("rcl_clear", "rcl_add", "rcl_add_guard", "rcl_wait"),
        *integers("clock_gettime", "memcpy", "wait_set", "guard"),
        *integers("message", "info", "clock", "count"),  # words that these functions fill in
        *integers("heard"),  # byte of the memory to which the message is copied
    ]
)
INPUT = np.dtype([*TOPIC, *integers("subscription")])
OUTPUT = np.dtype([*TOPIC, *integers("publisher", "message")])

_RECORDS = {"LOOP": LOOP, "INPUT": INPUT, "OUTPUT": OUTPUT, "RUN": RUN}
_TUPLES = {"Memory": Memory, "Steps": Steps, "Work": Work}
CODE = Code("node_steps", _TEXT, {**_RECORDS, **_TUPLES, "take_steps": take_steps})
