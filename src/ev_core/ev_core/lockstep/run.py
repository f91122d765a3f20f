"""A graph that is driven from instant to instant in this process: the parts of all roles over a stack of frames.

The stack holds a piece of the run, which stays in the processor's cache; its outputs then become
series.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from ev_core.compiled.interruptible import interruptible
from ev_core.compiled.loop import FINISHED, NOT_FINITE, Parts, run_instants
from ev_core.compiling.machine_code import call as call_at
from ev_core.lockstep.configuration import Configuration
from ev_core.lockstep.graph import check_graph, step_order
from ev_core.lockstep.parts import compiled_parts, method_part
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.fields import SignalError, shape_of
from ev_msgs_py.contract.frame import Frame
from ev_msgs_py.contract.roles import ROLES, RoleKind

_PIECE = 100  # instants between two looks at progress
_PIECES_PER_LOOK = 50  # pieces between two looks at what the parts note


def roles_in_order(played: Iterable[str]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The played roles that answer, each after everything that it reads, and those that integrate."""
    names = set(played)
    integrating = (role for role in ROLES if ROLES[role].kind is RoleKind.INTEGRATES)
    return tuple(role for role in step_order(ROLES) if role in names), tuple(
        r for r in integrating if r in names
    )


def refuse_not_finite(numbers: np.ndarray, signals: Iterable[type]) -> None:
    """SignalError that names the first number of these signals in a frame that is not finite."""
    for signal in signals:
        shape_of(signal).refuse_not_finite(numbers[frame.PLACES[signal]].tolist())


def call(part: Any, now: int, there: np.ndarray) -> None:
    """Let a part answer in the frame `there` to the frame at the address `now`, or start where that is 0."""
    function, state, constants = part.addresses()
    if guarded((part,), lambda: call_at(function, now, there.ctypes.data, state, constants)) != 0:
        raise raised(part, Frame.at(now).numbers if now else None)


def guarded(parts: Iterable[Any], drive: Callable[[], int]) -> int:
    """Call `drive`, which drives these parts; Ctrl-C ends the call where one is of a law that may never end."""
    driven = [*parts]
    if not any(getattr(part, "is_checked", False) for part in driven):
        return drive()
    status: int = interruptible(drive, driven)
    return status


def raised(part: Any, numbers: Sequence[float] | None) -> BaseException:
    """Error of a part that has failed with the numbers of a frame, None at its start."""
    error: BaseException = part.raised(numbers) if hasattr(part, "raised") else part.error
    return error


class GraphRun:
    """All parts of a graph, the `frames` of a piece of its run, and `series` of all, (frame size, instants).

    ParameterError if the configurations do not fit together.
    """

    def __init__(self, configurations: Mapping[str, Configuration], instants: int) -> None:
        check_graph(configurations)
        period = next(iter(configurations.values())).period
        answering, integrating = roles_in_order(configurations)
        self.writes = {
            role: configuration.method.writes for role, configuration in configurations.items()
        }
        roles = (*answering, *integrating)
        self.parts: list[tuple[str, Any]] = []
        for role in roles:
            self.parts += [(role, part) for part in compiled_parts(configurations[role])]
        written = {
            role: frame.span(configuration.method.writes)
            for role, configuration in configurations.items()
        }
        size = max(end for _, end in written.values())
        self.frames = np.zeros((min(_PIECE + 1, instants), size))
        self.series = np.empty((size, instants))
        self.series[frame.TIME] = frame.times(instants, period)
        self._answering = sum(role in answering for role, _ in self.parts)
        rows = [(*part.addresses(), *written[role]) for role, part in self.parts]
        self._rows = Parts(np.array(rows, np.int64), self._answering)
        for place in range(self._answering, len(self.parts)):
            self._show_start(place)

    def _show_start(self, place: int) -> None:
        role, part = self.parts[place]
        call(part, 0, self.frames[0])
        refuse_not_finite(self.frames[0], self.writes[role])

    def drive(self, progress: Callable[[float], None], note: Callable[[str, str], None]) -> None:
        """Drive all instants; SignalError, and nothing behind it is done, if a number is not finite."""
        last, noted = self.series.shape[1] - 1, set[tuple[str, str]]()
        stopped = np.zeros(2, np.int64)
        progress(0.0)
        for begin, end in _pieces(last):
            count = end - begin
            self.frames[: count + 1, frame.TIME] = self.series[frame.TIME, begin : end + 1]
            status = self._drive_piece(count, end == last, stopped)
            if status != FINISHED:
                raise self._error(status, *stopped.tolist())
            self.series[:, begin : end + 1] = self.frames[: count + 1].T
            self.frames[0] = self.frames[count]
            if end == last or end % (_PIECE * _PIECES_PER_LOOK) == 0:
                self._pass_on_notes(noted, note)
            progress(float(self.series[frame.TIME, end]))

    def _drive_piece(self, count: int, final: bool, stopped: np.ndarray) -> int:
        return guarded(
            (part for _, part in self.parts),
            lambda: run_instants(self.frames, 0, count, final, self._rows, stopped),
        )

    def _error(self, status: int, instant: int, place: int) -> BaseException:
        """The error of a part that stopped at an instant of a piece, with the time if a number is not finite."""
        role, part = self.parts[place]
        # of one that integrates it is the one before
        here = instant if place < self._answering else instant - 1
        try:
            if status == NOT_FINITE:
                refuse_not_finite(self.frames[instant], self.writes[role])
            raise raised(part, self.frames[here].tolist())
        except SignalError as error:
            return SignalError(f"at {self.frames[instant, frame.TIME]:g} s: {role}: {error}")
        except BaseException as error:  # of a law in plain Python: it is raised as it is
            return error

    def _pass_on_notes(self, noted: set[tuple[str, str]], note: Callable[[str, str], None]) -> None:
        """Pass on each note of a part when it appears for the first time."""
        for role, part in self.parts:
            for text in part.notes():
                if (role, text) not in noted:
                    noted.add((role, text))
                    note(role, text)


def output_again(configuration: Configuration, series: np.ndarray) -> np.ndarray:
    """The output of the part of a role that integrates for recorded inputs, without its sensors and faults.

    `series` are all numbers of the frame, (frame size, instants); the same with the part's output
    in its place. SignalError if a number of it is not finite.
    """
    part, writes = method_part(configuration, compiled=True), configuration.method.writes
    again, last = series.copy(), series.shape[1] - 1
    frames = np.zeros((min(_PIECE, last) + 1, len(series)))
    row = np.array([(*part.addresses(), *frame.span(writes))], np.int64)
    stopped = np.zeros(2, np.int64)
    for begin, end in _pieces(last):
        count = end - begin
        frames[: count + 1] = series[:, begin : end + 1].T
        if begin == 0:
            call(part, 0, frames[0])
        drive = partial(run_instants, frames, 0, count, False, Parts(row, 0), stopped)
        if guarded((part,), drive) != FINISHED:
            refuse_not_finite(frames[stopped[0]], writes)
            raise raised(part, frames[stopped[0] - 1].tolist())
        # the first instant of a piece is the last of the one before
        new = slice(int(begin > 0), count + 1)
        again[:, begin + new.start : end + 1] = frames[new].T
    return again


def _pieces(last: int) -> Iterator[tuple[int, int]]:
    """First and last instants of the pieces of a run, of which each begins where the one before ends."""
    for begin in range(0, max(last, 1), _PIECE):
        yield begin, min(begin + _PIECE, last)
