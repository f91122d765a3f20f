"""What a node takes and says, added up step by step, so that both ends of a topic can be compared when a run is over.

The sum of a topic goes over the numbers of all steps, as words of 32 bits, each times a secret odd number of its place
and one of its step, modulo 2^64 (multilinear hashing: Carter & Wegman 1979, Lemire & Kaser 2014). Who speaks in the
name of another node and does not know the key cannot choose other numbers that leave the sum as it was.
"""

from __future__ import annotations

import ctypes
import hashlib
from collections.abc import Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.compiling.machine_code import function_address
from ev_msgs_py.compiling.message_memory import integers
from ev_msgs_py.contract.frame import PLACES, SIZE
from ev_msgs_py.contract.topics import TOPICS

KEPT = 4  # sums of the newest steps: the two ends of a topic do not stop at the same one
TALLIED = np.dtype(integers("begin", "end"))  # the places of a topic in the frame
KEYS = 2 + 2 * SIZE
_WORD, _LOW = 32, 0xFFFFFFFF


class Sums(NamedTuple):
    """Which topics (n,) are added up, their `newest` sums (n, KEPT), and the keys (KEYS,)."""

    topics: Any
    newest: Any
    keys: Any


@compilable
def add_up(sums: Any, first: int, last: int, step: int, numbers: Any) -> None:
    """Add the numbers of topics `first` to `last` in the frame of a step to their newest sums."""
    topics, keys = sums.topics, sums.keys
    mixed = (step + 1) * keys[0]
    of_step = (mixed ^ (mixed >> 29)) * keys[1] | 1
    for i in range(first, last):
        total = 0
        for n in range(topics[i].begin, topics[i].end):
            word = np.float64(numbers[n]).view(np.int64)
            total += keys[2 + 2 * n] * (word & _LOW) + keys[3 + 2 * n] * (word >> _WORD)
        sums.newest[i, step % KEPT] = sums.newest[i, (step - 1) % KEPT] + total * of_step


_TEXT = f'''"""What nodes take and say, added up: generated, do not edit."""

import numpy as np
from numba import carray, cfunc, types

P, N = types.voidptr, types.int64


@cfunc(types.int32(P, N, N, N, P, P, N, P), error_model="numpy")
def step(topics, count, first, last, newest, keys, at, numbers):
    sums = Sums(
        carray(topics, count, TALLIED), carray(newest, (count, {KEPT}), np.int64), carray(keys, {KEYS}, np.int64)
    )
    add_up(sums, first, last, at, carray(numbers, {SIZE}, np.float64))
    return 0
'''
_P, _N = ctypes.c_void_p, ctypes.c_int64
_FUNCTION = ctypes.CFUNCTYPE(ctypes.c_int32, _P, _N, _N, _N, _P, _P, _N, _P)


@cache
def address() -> int:
    """Of the function as one of C."""
    return function_address("tally", _TEXT, {"TALLIED": TALLIED, "Sums": Sums, "add_up": add_up})


class Tally:
    """The sums of a node, with a key that the other nodes have as well: of what it `takes`, and of what it `says`."""

    def __init__(self, key: bytes, takes: Sequence[type], says: Sequence[type] = ()) -> None:
        taken, said = ([signal for signal in signals if signal in PLACES] for signals in (takes, says))
        self._signals, self.taken = (*taken, *said), len(taken)
        self.sums = Sums(
            np.array([(PLACES[signal].start, PLACES[signal].stop) for signal in self._signals], TALLIED),
            np.zeros((len(self._signals), KEPT), np.int64),
            np.frombuffer(hashlib.shake_256(key).digest(8 * KEYS), np.int64) | 1,
        )
        self._call = _FUNCTION(address())
        self._topics = self.sums.topics.ctypes.data, len(self._signals)
        self._sums = self.sums.newest.ctypes.data, self.sums.keys.ctypes.data

    def add_taken(self, step: int, numbers: int) -> None:
        """Add what was taken for a step, in the frame at an address."""
        self._call(*self._topics, 0, self.taken, *self._sums, step, numbers)

    def add_said(self, step: int, numbers: int) -> None:
        """Add what is said of a step, in the frame at an address."""
        self._call(*self._topics, self.taken, len(self._signals), *self._sums, step, numbers)

    def forget(self) -> None:
        """A new run begins."""
        self.sums.newest[:] = 0

    def newest(self, last_taken: int, last_said: int) -> dict[str, dict[str, dict[str, int]]]:
        """The last sums by "taken" and "said", topic and step, which count from these steps backwards."""
        found: dict[str, dict[str, dict[str, int]]] = {"taken": {}, "said": {}}
        for i, signal in enumerate(self._signals):
            kind, last = ("taken", last_taken) if i < self.taken else ("said", last_said)
            steps = range(max(last - KEPT + 1, 0), last + 1)
            found[kind][TOPICS[signal].name] = {str(step): int(self.sums.newest[i, step % KEPT]) for step in steps}
        return found
