"""What a node takes and says, added up step by step, so that both ends of a topic can be compared when a run is over.

The sum of a topic goes over the numbers of all steps, as words of 32 bits, each times a secret odd number of its place
and one of its step, modulo 2^64 (multilinear hashing: Carter & Wegman 1979, Lemire & Kaser 2014). Who speaks in the
name of another node and does not know the key cannot choose other numbers that leave the sum as it was.
"""

from __future__ import annotations

import ctypes
import hashlib
from array import array
from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np

from ev_core.compiling.foreign import call
from ev_core.compiling.machine_code import function_address
from ev_msgs_py.compilable import compilable
from ev_msgs_py.contract.frame import PLACES, SIZE, Frame
from ev_msgs_py.contract.topics import TOPICS

KEPT = 4  # sums of the newest steps: the two ends of a topic do not stop at the same one
_MOST = 64  # topics of a node
_KEYS = 2 + 2 * SIZE
# Where in the block of a node begin, behind the keys: the first and last place of each topic in the frame, its sums.
_TOPICS = _KEYS
_SUMS = _TOPICS + 2 * _MOST
BLOCK = _SUMS + KEPT * _MOST
_WORD, _LOW = 32, 0xFFFFFFFF
_BATCH, _FRAMES = 16, 4  # steps that are added up in one call; where their frames begin behind what is said of all


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
def add_up_steps(function: int, block: int, steps: Any, ahead: int) -> None:
    """Call the function that adds up one frame, at an address, for consecutive steps.

    `steps` has how many there are, the first of them, which topics are taken and said, and the addresses of two frames
    for each: of what was taken, and of what is said, which is of so many steps `ahead`.
    """
    for i in range(steps[0]):
        call(function, block, steps[2], steps[1] + i, steps[_FRAMES + 2 * i])
        call(function, block, steps[3], steps[1] + i + ahead, steps[_FRAMES + 2 * i + 1])


_HEAD = '''"""What nodes take and say, added up: generated, do not edit."""

import numpy as np
from numba import carray, cfunc, types

P, N = types.voidptr, types.int64
'''
_ONE = f"""
@cfunc(types.int32(P, N, N, P), error_model="numpy")
def step(block, topics, at, numbers):
    sums = carray(block, {BLOCK}, np.int64)
    add_up(sums, topics >> {_WORD}, topics & {_LOW}, at, carray(numbers, {SIZE}, np.float64))
    return 0
"""
_MANY = f"""
@cfunc(types.int32(N, N, P, N), error_model="numpy")
def step(function, block, steps, ahead):
    add_up_steps(function, block, carray(steps, {_FRAMES + 2 * _BATCH}, np.int64), ahead)
    return 0
"""
_N = ctypes.c_int64
_FUNCTION = ctypes.PYFUNCTYPE(ctypes.c_int32, _N, _N, _N, _N)


@cache
def addresses() -> tuple[int, int]:
    """Of what adds up one frame, and of what does so with many, as functions of C."""
    return (
        function_address("tally", _HEAD + _ONE, {"add_up": add_up}),
        function_address("tally_steps", _HEAD + _MANY, {"add_up_steps": add_up_steps}),
    )


class Tally:
    """The sums of a node, with a key that the other nodes have as well: of what it `takes`, and of what it `says`.

    What it says is of so many steps `ahead`. Frames are kept and added up many at a time, as a call costs more than
    the sum: nobody may change one afterwards.
    """

    def __init__(self, key: bytes, takes: Sequence[type], says: Sequence[type] = (), ahead: int = 0) -> None:
        taken, said = ([signal for signal in signals if signal in PLACES] for signals in (takes, says))
        self._signals, self.taken, self.count = (*taken, *said), len(taken), len(taken) + len(said)
        self.block = np.zeros(BLOCK, np.int64)
        self.block[:_KEYS] = np.frombuffer(hashlib.shake_256(key).digest(8 * _KEYS), np.int64) | 1
        for i, signal in enumerate(self._signals):
            self.block[_TOPICS + 2 * i : _TOPICS + 2 * i + 2] = PLACES[signal].start, PLACES[signal].stop
        self._sums = self.block[_SUMS:].reshape(_MOST, KEPT)
        self._one, self._many = (_FUNCTION(address) for address in addresses())
        self._at, self._ahead, self._topics_said = self.block.ctypes.data, ahead, self.taken << _WORD | self.count
        self._last = 0
        self._frames: list[Frame] = []

    def begin(self, step: int, said: Frame) -> None:
        """Add what is said of a step before any is taken."""
        self._one(self._at, self._topics_said, step, said.address)

    def add(self, step: int, taken: Frame, said: Frame) -> None:
        """Add what was taken for a step, the one after the last, and what is said thereupon."""
        self._last = step
        self._frames += taken, said
        if len(self._frames) == 2 * _BATCH:
            self.settle()

    def settle(self) -> None:
        """Add what waits, so that the block has the sums of all steps."""
        if self._frames:
            count = len(self._frames) // 2
            head = count, self._last - count + 1, self.taken, self._topics_said
            steps = array("q", [*head, *[frame.address for frame in self._frames]])
            self._many(addresses()[0], self._at, steps.buffer_info()[0], self._ahead)
            self._frames.clear()

    def forget(self) -> None:
        """A new run begins."""
        self._frames.clear()
        self._sums[:] = 0

    def newest(self, last_taken: int, last_said: int) -> dict[str, dict[str, dict[str, int]]]:
        """The last sums by "taken" and "said", topic and step, which count from these steps backwards."""
        self.settle()
        found: dict[str, dict[str, dict[str, int]]] = {"taken": {}, "said": {}}
        for i, signal in enumerate(self._signals):
            kind, last = ("taken", last_taken) if i < self.taken else ("said", last_said)
            steps = range(max(last - KEPT + 1, 0), last + 1)
            found[kind][TOPICS[signal].name] = {str(step): int(self._sums[i, step % KEPT]) for step in steps}
        return found
