"""Inputs and outputs of a node, added up step by step, so that both ends of a topic can be compared after a run.

How it works: the sum of a topic goes over the numbers of all steps, as words of 32 bits, each times
a secret odd number of its place and one of its step, modulo 2^64 (multilinear hashing: Carter &
Wegman 1979, Lemire & Kaser 2014). A sender in the name of another node that does not know the key
cannot choose other numbers that leave the sum unchanged.
"""

from __future__ import annotations

import ctypes
import hashlib
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from ev_core.compiling.machine_code import Code
from ev_core.lockstep.inbox import ANSWER, LAST, ROWS, Inbox, Steps, row_of, row_of_answer
from ev_msgs_py.compilable import compilable
from ev_msgs_py.contract.frame import PLACES, SIZE
from ev_msgs_py.contract.topics import TOPICS

READ, WRITTEN = "read", "written"  # of a node, in its report
KEPT = 4  # sums of the newest steps: the two ends of a topic do not stop at the same one
_MOST = 64  # topics of a node
_KEYS = 2 + 2 * SIZE
# Where in the block of a node begin, behind the keys: the first and last place of each topic in the
# frame, its sums. topics that are taken, all topics, steps from an input to its output
_TAKEN, _COUNT, _AHEAD = range(_KEYS, _KEYS + 3)
_PERIOD, _LEAD = _KEYS + 3, _KEYS + 4  # of the inbox with the added steps
_TOPICS = _KEYS + 5
_SUMS = _TOPICS + 2 * _MOST
BLOCK = _SUMS + KEPT * _MOST
_WORD, _LOW = 32, 0xFFFFFFFF


@compilable
def add_up(block: Any, first: int, last: int, step: int, numbers: Any) -> None:
    """Add the numbers of topics `first` to `last` in the frame of a step to their sums in the block (BLOCK,)."""
    mixed = (step + 1) * block[0]
    of_step = (mixed ^ (mixed >> 29)) * block[1] | 1
    for i in range(first, last):
        total = 0
        for n in range(block[_TOPICS + 2 * i], block[_TOPICS + 2 * i + 1]):
            word = np.float64(numbers[n]).view(np.int64)
            total += block[2 + 2 * n] * (word & _LOW) + block[3 + 2 * n] * (word >> _WORD)
        sums = _SUMS + KEPT * i
        block[sums + step % KEPT] = block[sums + (step - 1) % KEPT] + total * of_step


@compilable
def add_up_step(block: Any, step: int, taken: Any, output: Any) -> None:
    """Add the inputs of a step and the outputs that follow, each in its frame; of -1 - n the outputs of n."""
    if step >= 0:
        add_up(block, 0, block[_TAKEN], step, taken)
        add_up(block, block[_TAKEN], block[_COUNT], step + block[_AHEAD], output)
    else:
        add_up(block, block[_TAKEN], block[_COUNT], -1 - step, output)


@compilable
def add_up_newest(block: Any, steps: Any, frames: Any) -> None:
    """Add the inputs and outputs of the newest step of an inbox in its `frames`."""
    here, there = steps.done[LAST], steps.done[ANSWER]
    add_up_step(
        block,
        here // steps.period,
        frames[row_of(steps, here)],
        frames[row_of_answer(steps, there)],
    )


_TEXT = f'''"""Inputs and outputs of nodes, added up: generated, do not edit."""

import numpy as np
from numba import carray, cfunc, types

P, N = types.voidptr, types.int64


@cfunc(types.int32(P, N, P, P), error_model="numpy")
def step(block, at, taken, output):
    frames = carray(taken, {SIZE}, np.float64), carray(output, {SIZE}, np.float64)
    add_up_step(carray(block, {BLOCK}, np.int64), at, frames[0], frames[1])
    return 0
'''
_NEWEST = f'''"""The newest inputs and outputs of nodes, added up: generated, do not edit."""

import numpy as np
from numba import carray, cfunc, types

P = types.voidptr


@cfunc(types.int32(P, P, P), error_model="numpy")
def step(block, steps, frames):
    b, s = carray(block, {BLOCK}, np.int64), carray(steps, {3 + 2 * ROWS}, np.int64)
    kept = Steps(s[:3], s[3:{3 + ROWS}], s[{3 + ROWS}:], 0, 0, 0, b[{_PERIOD}], b[{_LEAD}], 0)
    add_up_newest(b, kept, carray(frames, ({ROWS + 2}, {SIZE}), np.float64))
    return 0
'''
_P, _N = ctypes.c_void_p, ctypes.c_int64
# PYFUNCTYPE keeps the interpreter's lock: releasing it would take longer than the sums.
_FUNCTION = ctypes.PYFUNCTYPE(ctypes.c_int32, _P, _N, _P, _P)
_NEWEST_FUNCTION = ctypes.PYFUNCTYPE(ctypes.c_int32, _P, _P, _P)

ANY_STEP = Code("tally", _TEXT, {"add_up_step": add_up_step})
NEWEST_STEP = Code("newest_tally", _NEWEST, {"add_up_newest": add_up_newest, "Steps": Steps})


class Tally:
    """The sums of a node, with a key that the other nodes have as well: of its inputs and of its outputs.

    An output is `ahead` of its inputs by 0 steps or, of a node that integrates, by 1.
    """

    def __init__(
        self, key: bytes, reads: Sequence[type], writes: Sequence[type] = (), ahead: int = 0
    ) -> None:
        taken = [signal for signal in reads if signal in PLACES]
        output = [signal for signal in writes if signal in PLACES]
        self._signals, self._taken = (*taken, *output), len(taken)
        self.block = np.zeros(BLOCK, np.int64)
        self.block[:_KEYS] = np.frombuffer(hashlib.shake_256(key).digest(8 * _KEYS), np.int64) | 1
        self.block[_TAKEN], self.block[_COUNT], self.block[_AHEAD] = (
            self._taken,
            len(self._signals),
            ahead,
        )
        for i, signal in enumerate(self._signals):
            self.block[_TOPICS + 2 * i : _TOPICS + 2 * i + 2] = (
                PLACES[signal].start,
                PLACES[signal].stop,
            )
        self._sums = self.block[_SUMS:].reshape(_MOST, KEPT)
        # add(step, taken, output): the inputs of a step and the outputs that follow, in the frames
        # at two addresses.
        self.add = partial(_FUNCTION(ANY_STEP.address()), self.block.ctypes.data)

    def adder(self, inbox: Inbox) -> Callable[[], int]:
        """A function that adds the newest step of an inbox, as often as it is called.

        It is not wrapped and takes no arguments from Python: both would take as long as the sums.
        """
        self.block[_PERIOD], self.block[_LEAD] = inbox.steps.period, inbox.steps.lead
        return partial(
            _NEWEST_FUNCTION(NEWEST_STEP.address()), self.block.ctypes.data, *inbox.addresses
        )

    def begin(self, step: int, output: int) -> None:
        """Add the outputs of a step before which there was no input, in the frame at an address."""
        self.add(-1 - step, output, output)

    def forget(self) -> None:
        """Begin a new run."""
        self._sums[:] = 0

    def newest(self, last_taken: int, last_output: int) -> dict[str, dict[str, dict[str, int]]]:
        """The last sums by "read" and "written", topic and step, which count from these steps backwards."""
        found: dict[str, dict[str, dict[str, int]]] = {READ: {}, WRITTEN: {}}
        for i, signal in enumerate(self._signals):
            kind, last = (READ, last_taken) if i < self._taken else (WRITTEN, last_output)
            steps = range(max(last - KEPT + 1, 0), last + 1)
            found[kind][TOPICS[signal].name] = {
                str(step): int(self._sums[i, step % KEPT]) for step in steps
            }
        return found
