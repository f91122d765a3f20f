"""A part that keeps of a run what a batch is asked for: some channels now and then, and reductions.

It writes nothing into the frame in which it stands: behind all that answer, or behind a part that
integrates. Two rows of numbers are its memory:

    constants  every  channels  reductions  samples  their places ...  kind and place of each reduction ...
    state      instant  reductions ...  the samples of the first channel ...  of the second ...
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache, partial
from typing import NamedTuple

import numpy as np

from ev_core.compiling.machine_code import Code
from ev_msgs_py.compilable import compilable
from ev_msgs_py.contract import frame

MINIMUM, MAXIMUM, LARGEST_MAGNITUDE, LAST, MEAN, ROOT_MEAN_SQUARE = range(6)
# Numbers of the constants before the places: every, channels, reductions, samples.
HEAD = 4
# It reads `next`, which the parts before it have written: behind those that answer that is the
# frame of the instant itself, behind those that integrate the frame of the next one.
_TEXT = f'''"""The observer of a batch: generated, do not edit."""

from numba import carray, cfunc, types

P = types.voidptr


@cfunc(types.int32(P, P, P, P), error_model="numpy")
def step(now, next, state, constants):
    head = carray(constants, {HEAD}, FLOAT)
    asked = carray(constants, {HEAD} + int(head[1] + 2.0 * head[2]), FLOAT)
    kept = carray(state, 1 + int(head[2] + head[1] * head[3]), FLOAT)
    observe(carray(next, {frame.SIZE}, FLOAT), kept, asked)
    return 0
'''


class Reduction(NamedTuple):
    """A reduction: one number of all samples of a channel, such as imu.yaw_rate, from the start on.

    Samples are those of each control period and of both ends: their smallest, largest or last one,
    the largest magnitude, their mean, and the root of the mean of their squares.
    """

    kind: int
    channel: str


minimum, maximum, largest_magnitude, last, mean, root_mean_square = (
    partial(Reduction, kind) for kind in range(6)
)


def result(kind: int, reduced: np.ndarray, instants: int) -> np.ndarray:
    """The numbers that are meant, from what the compiled loop has gathered (`observer`)."""
    if kind == MEAN:
        return reduced / instants
    return np.sqrt(reduced / instants) if kind == ROOT_MEAN_SQUARE else reduced.copy()


@compilable
def observe(now: np.ndarray, state: np.ndarray, c: np.ndarray) -> None:
    """Take from the frame of an instant what is asked for."""
    instant, every, channels, reductions, samples = (
        int(state[0]),
        int(c[0]),
        int(c[1]),
        int(c[2]),
        int(c[3]),
    )
    for i in range(reductions):
        place = HEAD + channels + 2 * i
        value = now[int(c[place + 1])]
        # The first sample starts an extreme, for which 0 would count as a value; sums start at 0.
        state[1 + i] = (
            value if instant == 0 and c[place] < MEAN else reduced(c[place], state[1 + i], value)
        )
    if instant % every == 0:
        # Channel by channel, so that the samples of one are contiguous.
        begin = 1 + reductions + instant // every
        for i in range(channels):
            state[begin + i * samples] = now[int(c[HEAD + i])]
    state[0] += 1.0


@compilable
def reduced(kind: float, before: float, value: float) -> float:
    """A reduction with one more value; for the mean and that of squares their sums."""
    if kind == MINIMUM:
        return min(before, value)
    if kind == MAXIMUM:
        return max(before, value)
    if kind == LARGEST_MAGNITUDE:
        return max(abs(before), abs(value))
    if kind == LAST:
        return value
    return before + (value if kind == MEAN else value * value)


OBSERVER = Code("observer", _TEXT, {"FLOAT": np.float64, "observe": observe})


@cache
def function() -> int:
    """The address of the compiled observer."""
    return OBSERVER.address()


class Observation:
    """The memory of the observers of all runs."""

    def __init__(
        self,
        channels: Sequence[str],
        every: int,
        reductions: Sequence[Reduction],
        runs: int,
        instants: int,
    ) -> None:
        places = frame.channels()
        self._samples = (instants - 1) // every + 1
        asked = [
            every,
            len(channels),
            len(reductions),
            self._samples,
            *(places[name] for name in channels),
        ]
        for reduction in reductions:
            asked += [reduction.kind, places[reduction.channel]]
        self._constants = np.array(asked, float)
        self._channels, self._head = channels, 1 + len(reductions)
        # NaN remains where a run stops before the end.
        self._kept = np.full((runs, self._head + len(channels) * self._samples), np.nan)
        self._kept[:, : self._head] = 0.0

    def addresses(self) -> tuple[int, int, int]:
        """The addresses of the function, the row of the first run and the constants."""
        return function(), self._kept.ctypes.data, self._constants.ctypes.data

    def state(self, run: int = 0) -> np.ndarray:
        """The row of a run."""
        row: np.ndarray = self._kept[run]
        return row

    def reduced(self) -> np.ndarray:
        """Results of each reduction, (runs, reductions)."""
        return self._kept[:, 1 : self._head].copy()

    def signals(self) -> dict[str, np.ndarray]:
        """Samples of each run by channel, (runs, samples); NaN where there is none."""
        samples = self._kept[:, self._head :].reshape(
            len(self._kept), len(self._channels), self._samples
        )
        return {name: np.ascontiguousarray(samples[:, i]) for i, name in enumerate(self._channels)}
