"""Inputs and outputs of a node, added up step by step, so that both ends of a topic can be compared after a run.

The sum of a topic goes over the numbers of all steps, as words of 32 bits, each times a secret odd number of its place
and one of its step, modulo 2^64 (multilinear hashing: Carter & Wegman 1979, Lemire & Kaser 2014). Who speaks in the
name of another node and does not know the key cannot choose other numbers that leave the sum as it was.
"""

from __future__ import annotations

import ctypes
import hashlib
from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np

from ev_core.compiling.machine_code import function_address
from ev_msgs_py.compilable import compilable
from ev_msgs_py.contract.frame import PLACES, SIZE
from ev_msgs_py.contract.topics import TOPICS

KEPT = 4  # sums of the newest steps: the two ends of a topic do not stop at the same one
_MOST = 64  # topics of a node
_KEYS = 2 + 2 * SIZE
# Where in the block of a node begin, behind the keys: the first and last place of each topic in the frame, its sums.
_TOPICS = _KEYS
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


_TEXT = f'''"""What nodes take and say, added up: generated, do not edit."""

import numpy as np
from numba import carray, cfunc, types

P, N = types.voidptr, types.int64


@cfunc(types.int32(P, N, N, N, P), error_model="numpy")
def step(block, first, last, at, numbers):
    add_up(carray(block, {BLOCK}, np.int64), first, last, at, carray(numbers, {SIZE}, np.float64))
    return 0
'''
_P, _N = ctypes.c_void_p, ctypes.c_int64
_FUNCTION = ctypes.CFUNCTYPE(ctypes.c_int32, _P, _N, _N, _N, _P)


@cache
def address() -> int:
    """Of the function as one of C."""
    return function_address("tally", _TEXT, {"add_up": add_up})


class Tally:
    """The sums of a node, with a key that the other nodes have as well: of what it `takes`, and of its outputs."""

    def __init__(self, key: bytes, takes: Sequence[type], says: Sequence[type] = ()) -> None:
        taken, said = ([signal for signal in signals if signal in PLACES] for signals in (takes, says))
        self._signals, self.taken, self.count = (*taken, *said), len(taken), len(taken) + len(said)
        self.block = np.zeros(BLOCK, np.int64)
        self.block[:_KEYS] = np.frombuffer(hashlib.shake_256(key).digest(8 * _KEYS), np.int64) | 1
        for i, signal in enumerate(self._signals):
            self.block[_TOPICS + 2 * i : _TOPICS + 2 * i + 2] = PLACES[signal].start, PLACES[signal].stop
        self._sums = self.block[_SUMS:].reshape(_MOST, KEPT)
        self._call, self._at = _FUNCTION(address()), self.block.ctypes.data

    def add_taken(self, step: int, numbers: int) -> None:
        """Add what was taken for a step, in the frame at an address."""
        self._call(self._at, 0, self.taken, step, numbers)

    def add_said(self, step: int, numbers: int) -> None:
        """Add the outputs of a step, in the frame at an address."""
        self._call(self._at, self.taken, self.count, step, numbers)

    def forget(self) -> None:
        """A new run begins."""
        self._sums[:] = 0

    def newest(self, last_taken: int, last_said: int) -> dict[str, dict[str, dict[str, int]]]:
        """The last sums by "taken" and "said", topic and step, which count from these steps backwards."""
        found: dict[str, dict[str, dict[str, int]]] = {"taken": {}, "said": {}}
        for i, signal in enumerate(self._signals):
            kind, last = ("taken", last_taken) if i < self.taken else ("said", last_said)
            steps = range(max(last - KEPT + 1, 0), last + 1)
            found[kind][TOPICS[signal].name] = {str(step): int(self._sums[i, step % KEPT]) for step in steps}
        return found
