"""A graph that is driven from instant to instant in this process.

How it works: the parts of all roles work on a stack of frames, one for each instant of a piece of
the run. Compiled code drives a whole piece. A piece stays in the processor's cache; behind it its
frames are copied into the series of the run, and its last frame begins the next piece.
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
    """The played roles that answer, each after all that it reads, and those that integrate."""
    names = set(played)
    answering = tuple(role for role in step_order(ROLES) if role in names)
    integrating: list[str] = []
    for name, role in ROLES.items():
        if name in names and role.kind is RoleKind.INTEGRATES:
            integrating.append(name)
    return answering, tuple(integrating)


def refuse_not_finite(numbers: np.ndarray, signals: Iterable[type]) -> None:
    """SignalError that names the first number of these signals in a frame that is not finite."""
    for signal in signals:
        shape_of(signal).refuse_not_finite(numbers[frame.PLACES[signal]].tolist())


def call(part: Any, now: int, there: np.ndarray) -> None:
    """Let a part answer in the frame `there` to the one at the address `now`; 0 starts it."""
    function, state, constants = part.addresses()
    drive = partial(call_at, function, now, there.ctypes.data, state, constants)
    if guarded((part,), drive) != 0:
        raise raised(part, Frame.at(now).numbers if now else None)


def guarded(parts: Iterable[Any], drive: Callable[[], int]) -> int:
    """Call `drive`, which drives these parts.

    Ctrl-C ends the call where one is of a law that may never end.
    """
    driven = [*parts]
    # Our own laws end. Only a law of others takes a thread that can be given up.
    if not any(getattr(part, "is_checked", False) for part in driven):
        return drive()
    status: int = interruptible(drive, driven)
    return status


def raised(part: Any, numbers: Sequence[float] | None) -> BaseException:
    """Error of a part that has failed with the numbers of a frame, None at its start."""
    # A compiled part steps again in plain Python; one that is called back has kept its error.
    error: BaseException = part.raised(numbers) if hasattr(part, "raised") else part.error
    return error


class GraphRun:
    """All parts of a graph, and the frames of its run.

    `frames` are those of a piece, `series` all, (frame size, instants).

    ParameterError if the configurations do not fit together.
    """

    def __init__(self, configurations: Mapping[str, Configuration], instants: int) -> None:
        check_graph(configurations)
        period = next(iter(configurations.values())).period
        answering, integrating = roles_in_order(configurations)
        self.writes: dict[str, tuple[type, ...]] = {}
        written: dict[str, tuple[int, int]] = {}
        for role, configuration in configurations.items():
            self.writes[role] = configuration.method.writes
            written[role] = frame.span(configuration.method.writes)
        self.parts: list[tuple[str, Any]] = []
        for role in (*answering, *integrating):
            self.parts += [(role, part) for part in compiled_parts(configurations[role])]
        # Optional signals come last in a frame: without them it is shorter.
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
        """Drive all instants.

        SignalError where a number is not finite: nothing behind it is done.
        """
        last = self.series.shape[1] - 1
        noted = set[tuple[str, str]]()
        stopped = np.zeros(2, np.int64)  # where a piece stopped: instant and place of the part
        progress(0.0)
        for begin, end in _pieces(last):
            count = end - begin
            self.frames[: count + 1, frame.TIME] = self.series[frame.TIME, begin : end + 1]
            status = self._drive_piece(count, end == last, stopped)
            if status != FINISHED:
                raise self._error(status, *stopped.tolist())
            self.series[:, begin : end + 1] = self.frames[: count + 1].T
            self.frames[0] = self.frames[count]
            # Notes take plain Python, so they are looked at rarely, and at the end.
            if end == last or end % (_PIECE * _PIECES_PER_LOOK) == 0:
                self._pass_on_notes(noted, note)
            progress(float(self.series[frame.TIME, end]))

    def _drive_piece(self, count: int, final: bool, stopped: np.ndarray) -> int:
        return guarded(
            (part for _, part in self.parts),
            lambda: run_instants(self.frames, 0, count, final, self._rows, stopped),
        )

    def _error(self, status: int, instant: int, place: int) -> BaseException:
        """The error of a part that stopped at an instant of a piece.

        It has the time if a number is not finite.
        """
        role, part = self.parts[place]
        # A part that answers reads the frame of the instant, one that integrates the one before.
        here = instant if place < self._answering else instant - 1
        try:
            if status == NOT_FINITE:
                refuse_not_finite(self.frames[instant], self.writes[role])
            raise raised(part, self.frames[here].tolist())
        except SignalError as error:
            return SignalError(f"at {self.frames[instant, frame.TIME]:g} s: {role}: {error}")
        except BaseException as error:
            # An error of a law in plain Python is raised as it is, also an exit.
            return error

    def _pass_on_notes(self, noted: set[tuple[str, str]], note: Callable[[str, str], None]) -> None:
        """Pass on each note of a part when it appears for the first time."""
        for role, part in self.parts:
            for text in part.notes():
                if (role, text) not in noted:
                    noted.add((role, text))
                    note(role, text)


def output_again(configuration: Configuration, series: np.ndarray) -> np.ndarray:
    """The output of the part of an integrating role for recorded inputs.

    Sensors and faults are left out. `series` are all numbers of the frame, (frame size, instants);
    the result is the same with the part's output in its place. SignalError if a number of it is not
    finite.
    """
    part = method_part(configuration, compiled=True)
    writes = configuration.method.writes
    again = series.copy()
    last = series.shape[1] - 1
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
        # The first instant of a piece is the last of the one before, and there already.
        new = slice(int(begin > 0), count + 1)
        again[:, begin + new.start : end + 1] = frames[new].T
    return again


def _pieces(last: int) -> Iterator[tuple[int, int]]:
    """First and last instants of the pieces of a run; each begins where the last one ends."""
    for begin in range(0, max(last, 1), _PIECE):
        yield begin, min(begin + _PIECE, last)
