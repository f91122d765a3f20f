"""Outcome of driving one run, and its progress bar: simulated time and real-time factor."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from tqdm import tqdm

from ev_stack.recording.recording import Recording

Progress = Callable[[float], None]  # is called with the simulated time now and then
_FORMAT = "{desc} {percentage:3.0f} %|{bar:30}| {n:.1f}/{total:.1f} s simulated, {unit} x real time"
_ENOUGH = 0.05  # s of wall time from which on a real-time factor has a meaning
_COUNTING = "compiling (once) {n} of {total} |{bar:30}| {elapsed}<{remaining}"


class RunFailed(RuntimeError):
    """A run did not come to its end; the message is one line for the user."""


@dataclass(frozen=True)
class Outcome:
    """The signals of a run, the wall time of driving [s], why it may not be reproducible, and what nodes noted.

    `timing` is how well real time was kept (`ev_nodes/master/real_time.py`), empty of a run in
    lockstep.
    """

    recording: Recording
    wall_time: float
    not_reproducible: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    timing: Mapping[str, Any] = field(default_factory=dict)


def announce(text: str) -> None:
    """A line on standard error, printed before the progress begins."""
    tqdm.write(text, file=sys.stderr)
    sys.stderr.flush()


@contextmanager
def progress_bar(name: str, duration: float) -> Iterator[Progress]:
    """A bar on standard error; in a file or pipe a line every few seconds at most."""
    interactive = sys.stderr.isatty()
    bar = tqdm(
        desc=name,
        total=duration,
        bar_format=_FORMAT,
        unit="-",  # the place where the format has room for the real-time factor
        mininterval=0.1 if interactive else 5.0,
        leave=True,
        ascii=not interactive,
    )
    # wall and simulated time of the first look at a car under way
    begun: list[tuple[float, float]] = []

    def progress(simulated: float) -> None:
        now = time.monotonic()
        if begun and simulated < begun[0][1]:  # a reset
            begun.clear()
        if not begun and simulated > 0:
            begun.append((now, simulated))
        if begun and now - begun[0][0] > _ENOUGH:
            bar.unit = f"{(simulated - begun[0][1]) / (now - begun[0][0]):.1f}"
        bar.update(min(simulated, duration) - bar.n)

    with bar:
        yield progress
        bar.refresh()


def bar_of_code(total: int) -> tqdm:
    """A bar on standard error that counts what is compiled."""
    tqdm.monitor_interval = 0  # else it starts a thread, and workers are forked off this process
    ascii = not sys.stderr.isatty()
    return tqdm(
        total=total,
        bar_format=_COUNTING,
        ascii=ascii,
        mininterval=0.0 if sys.stderr.isatty() else 5.0,
    )


def bar_of_runs(name: str, total: int, before: int = 0) -> tqdm:
    """A bar on standard error that counts runs; so many were driven before."""
    tqdm.monitor_interval = 0  # else it starts a thread, and workers are forked off this process
    ascii = not sys.stderr.isatty()
    return tqdm(desc=name, total=total, initial=before, unit="run", ascii=ascii, mininterval=0.5)
