"""A configured method as the checks step it: frame by frame, and all that it says as bytes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Protocol

import numpy as np

from ev_core.check.inputs import RandomInputs
from ev_core.lockstep.configuration import Configuration
from ev_core.lockstep.parts import method_part
from ev_core.methods.part import Part
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.fields import shape_of
from ev_msgs_py.contract.frame import Frame
from ev_msgs_py.contract.signals import Instant


class Inputs(Protocol):
    """Signals for one step after the other."""

    def next(self) -> tuple[Any, ...]:
        """The signals of the next step, in the order in which the method reads them."""


# Makes inputs from the signals that are read, a seed and the control period [s].
MakesInputs = Callable[[Sequence[type], int, float], Inputs]


@dataclass(frozen=True)
class Subject:
    """What is checked: a configured method, in plain Python or compiled, and what it is given."""

    configuration: Configuration
    compiled: bool
    steps: int
    inputs: MakesInputs = RandomInputs

    @property
    def form(self) -> str:
        """How it runs, in words."""
        return "compiled" if self.compiled else "in plain Python"

    def part(self) -> Part:
        """A new part, at rest; heavy laws are compiled in any case."""
        part: Part = method_part(self.configuration, self.compiled)
        return part

    def frames(self, seed: int) -> tuple[Frame, ...]:
        """What the method reads, step by step; for reading only."""
        method, period = self.configuration.method, self.configuration.common.control_period
        return _frames(self.inputs, method.reads, seed, period, self.steps)


@lru_cache(maxsize=8)  # each check asks for the same ones
def _frames(
    make_inputs: MakesInputs, reads: tuple[type, ...], seed: int, period: float, steps: int
) -> tuple[Frame, ...]:
    inputs = make_inputs(reads, seed, period)
    return tuple(frame_of(reads, inputs.next()) for _ in range(steps))


def frame_of(reads: Sequence[type], signals: Sequence[Any]) -> Frame:
    """The frame of an instant that holds these signals, and zeros."""
    here = Frame()
    for kind, signal in zip(reads, signals, strict=True):
        if kind is Instant:
            here.numbers[frame.TIME] = signal.time
        else:
            here.numbers[frame.PLACES[kind]] = frame.numbers_of(shape_of(kind).flat(signal))
    return here


def stepped(part: Part, here: Frame) -> bytes:
    """All that a part says in one step."""
    given, there = Frame(), Frame()
    given.numbers[:] = here.numbers
    part.step(given, there)
    return there.numbers.tobytes()


def said(part: Part, frames: Iterable[Frame]) -> list[bytes]:
    """All that a part says in one step after the other."""
    return [stepped(part, here) for here in frames]


def numbers_in(raw: bytes) -> np.ndarray:
    """The numbers of a frame."""
    return np.frombuffer(raw)


def difference(subject: Subject, one: Sequence[bytes], other: Sequence[bytes]) -> str:
    """Where two runs differ first, with both values; empty if nowhere."""
    for step, (first, second) in enumerate(zip(one, other, strict=True)):
        if first != second:
            return f"step {step}: {_channel(subject, first, second)}"
    return ""


def _channel(subject: Subject, first: bytes, second: bytes) -> str:
    for kind in subject.configuration.method.writes:
        for channel, place in zip(shape_of(kind).channels, frame.places(kind), strict=True):
            pair = [numbers_in(raw)[place : place + 1] for raw in (first, second)]
            if pair[0].tobytes() != pair[1].tobytes():
                return f"{kind.__name__}.{channel} is {pair[0][0]!s} and {pair[1][0]!s}"
    return "what it does not write"
