"""The ordinary steps of a node in lockstep as one compiled loop: messages in, a step, messages out, sleep.

Ordinary is a message from the one who may speak, laid out as our nodes do, finite, and of the step that is due.
Whatever else comes ends the loop and is for Python to judge (`lockstep/inbox.py`). `records.py` tells what the
records hold.
"""

from __future__ import annotations

from time import CLOCK_MONOTONIC
from typing import Any

from ev_core.compiling.machine_code import call
from ev_core.lockstep.tally import add_up
from ev_core.node_loop.message_memory import is_laid_out_like, read_numbers, stamp_in, write_message
from ev_msgs_py.compilable import compilable
from ev_msgs_py.contract.frame import TIME
from ev_msgs_py.contract.stamps import NANOSECONDS

# Why the loop has ended: nothing came in time; a message is for Python to judge; the last step that may be taken was
# taken; the part has failed, or has written what is not finite.
IDLE, ODD, LIMIT, FAILED, NOT_FINITE = range(5)
_NOTHING, _KEPT, _REFUSED = range(-3, 0)  # what else can become of a message

_AT_ONCE = 100  # messages of one input that are taken between two looks at the others

GID = 5  # word of the information on a message at which the identity of its publisher begins, two words long


@compilable
def take_steps(
    head: Any, inputs: Any, outputs: Any, runs: Any, senders: Any, frames: Any, memory: Any, tally: Any
) -> int:
    """Take steps until there is a reason to stop, which is returned.

    `frames` has four rows: the inputs of two steps, which take turns in being due, and what is said to them. Of the
    `senders` (inputs, n, 2) the first may speak, and the others are known to be refused.
    """
    while True:
        came = False
        for i in range(len(inputs)):
            for _ in range(_AT_ONCE):
                if not _is_missing(inputs[i]):
                    break
                found = _take(head, inputs[i], senders[i], runs, frames, memory)
                if found == ODD:
                    head.odd = i
                    return ODD
                if found == _NOTHING:
                    break
                came = came or found == _KEPT
        missing = _last_missing(inputs)
        if missing < 0:
            if head.due > head.limit:
                return LIMIT
            failure = _step(head, inputs, frames, tally)
            if failure:
                return failure
            _speak(head, outputs, runs, frames, memory)
        elif not came and not _sleep(head, inputs[missing].subscription, memory):
            return IDLE


@compilable
def _is_missing(one: Any) -> Any:
    """Whether the step that is due lacks an input; of a followed one that of the step behind it is needed as well."""
    return one.came == 0 or (one.followed != 0 and one.came_next == 0)


@compilable
def _last_missing(inputs: Any) -> int:
    last = -1
    for i in range(len(inputs)):
        if _is_missing(inputs[i]):
            last = i
    return last


@compilable
def _take(head: Any, one: Any, senders: Any, runs: Any, frames: Any, memory: Any) -> int:
    """Take the next message of an input, and keep its numbers if it is an ordinary one."""
    here = memory.words.ctypes.data
    if call(head.rcl_take, one.subscription, here + 8 * head.message, here + 8 * head.info, 0) != 0:
        return _NOTHING
    low, high = memory.words[head.info + GID], memory.words[head.info + GID + 1]
    if low != senders[0, 0] or high != senders[0, 1]:
        for k in range(1, len(senders)):
            if low == senders[k, 0] and high == senders[k, 1]:
                one.refused += 1
                return _REFUSED
        return ODD
    buffer, length = memory.words[head.message], memory.words[head.message + 1]
    if length != one.length:
        return ODD
    call(head.memcpy, here + head.heard, buffer, length, 0)
    stamp = stamp_in(memory, head.heard)
    is_next = stamp == head.due + head.period and one.followed != 0 and one.came_next == 0
    if not (is_next or (stamp == head.due and one.came == 0)) or not is_laid_out_like(memory, head.heard, one):
        return ODD
    if not read_numbers(memory, head.heard, one, runs, frames[1 - head.row if is_next else head.row]):
        return ODD
    if is_next:
        one.came_next = 1
    else:
        one.came = 1
    return _KEPT


@compilable
def _step(head: Any, inputs: Any, frames: Any, tally: Any) -> int:
    """One step of the part; what it says stands in the row of the inputs or, if it integrates, two rows behind."""
    said = head.row + 2 if head.integrates else head.row
    due = head.due - head.run
    frames[head.row, TIME] = due / NANOSECONDS
    if head.integrates:
        frames[said, TIME] = (due + head.period) / NANOSECONDS
    head.said = said
    first, width = frames.ctypes.data, 8 * frames.shape[1]
    if call(head.function, first + head.row * width, first + said * width, head.state, head.constants) != 0:
        return FAILED
    for n in range(head.begin, head.end):
        if frames[said, n] - frames[said, n] != 0.0:
            return NOT_FINITE
    if head.tallied:
        step = due // head.period
        add_up(tally, 0, head.taken_topics, step, frames[head.row])
        add_up(tally, head.taken_topics, head.tallied, step + 1 if head.integrates else step, frames[said])
    for i in range(len(inputs)):
        inputs[i].came, inputs[i].came_next = inputs[i].came_next, 0
    head.due += head.period
    head.row = 1 - head.row
    head.taken += 1
    return 0


@compilable
def _speak(head: Any, outputs: Any, runs: Any, frames: Any, memory: Any) -> None:
    """Publish what the last step has said, as far as somebody hears it."""
    stamp = head.due if head.integrates else head.due - head.period
    here = memory.words.ctypes.data
    for i in range(len(outputs)):
        call(head.rcl_count, outputs[i].publisher, here + 8 * head.count, 0, 0)
        if memory.words[head.count] != 0:
            write_message(memory, outputs[i], runs, stamp, frames[head.said])
            call(head.rcl_publish, outputs[i].publisher, here + 8 * outputs[i].message, 0, 0)
    head.spoke = _wall_clock(head, memory)


@compilable
def _sleep(head: Any, subscription: int, memory: Any) -> bool:
    """Sleep until a message comes; False if there is none in time."""
    left = min(head.patience, head.until - _wall_clock(head, memory))
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
