"""A graph that is driven from instant to instant in this process: the parts of all roles over one row of frames."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from ev_msgs_py.compiling.loop import FINISHED, NOT_FINITE, call_part, run_instants
from ev_msgs_py.configuration import Configuration, check_graph
from ev_msgs_py.contract import frame
from ev_msgs_py.graph import step_order
from ev_msgs_py.lockstep.parts import part_of
from ev_msgs_py.roles import ROLES, RoleKind
from ev_msgs_py.shape import shape_of

_CHUNK = 100  # instants between two looks at progress and notes


class GraphRun:
    """All parts of a graph and the frames of `instants` instants, of shape (instants, frame size).

    ParameterError if the configurations do not fit together.
    """

    def __init__(self, configurations: Mapping[str, Configuration], instants: int) -> None:
        check_graph(configurations)
        period = next(iter(configurations.values())).period
        integrating = [role for role in configurations if ROLES[role].kind is RoleKind.INTEGRATES]
        answering = step_order(ROLES)
        self.roles = (*answering, *integrating)
        self.writes = {role: configurations[role].method.writes for role in self.roles}
        self.parts = {role: part_of(configurations[role], compiled=True) for role in self.roles}
        self.frames = frame.stack(instants, period)
        self._answering = len(answering)
        self._rows = np.array([self._row(role) for role in self.roles], np.int64)
        for role in integrating:
            self._show_start(role)

    def _row(self, role: str) -> tuple[int, ...]:
        """What the compiled loop has to know of a part."""
        places = [frame.PLACES[signal] for signal in ROLES[role].writes]
        begin, end = min(place.start for place in places), max(place.stop for place in places)
        return (*self.parts[role].addresses(), begin, end)

    def _show_start(self, role: str) -> None:
        function, state, constants = self.parts[role].addresses()
        if call_part(function, 0, self.frames.ctypes.data, state, constants) != 0:
            self._raise(role)
        self._refuse_not_finite(role, 0)

    def drive(self, progress: Callable[[float], None], note: Callable[[str, str], None]) -> None:
        """Drive all instants; SignalError, and nothing behind it is done, if a number is not finite."""
        last, said = len(self.frames) - 1, set()
        stopped = np.zeros(2, np.int64)
        progress(0.0)
        for begin in range(0, max(last, 1), _CHUNK):
            end = min(begin + _CHUNK, last)
            status = run_instants(self.frames, begin, end, end == last, self._rows, self._answering, stopped)
            if status != FINISHED:
                role = self.roles[stopped[1]]
                if status == NOT_FINITE:
                    self._refuse_not_finite(role, stopped[0])
                self._raise(role)
            for role, part in self.parts.items():
                for text in part.notes():
                    if (role, text) not in said:
                        said.add((role, text))
                        note(role, text)
            progress(float(self.frames[end, frame.TIME]))

    def _raise(self, role: str) -> None:
        raise self.parts[role].error

    def _refuse_not_finite(self, role: str, instant: int) -> None:
        for signal in self.writes[role]:
            shape_of(signal).refuse_not_finite(self.frames[instant, frame.PLACES[signal]].tolist())
