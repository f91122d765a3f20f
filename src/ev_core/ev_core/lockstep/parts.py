"""Parts that play a configured role, with its sensors and faults, in plain Python or compiled."""

from __future__ import annotations

import copy
from collections.abc import Collection, Iterable, Sequence
from contextlib import suppress
from typing import Any

import numpy as np

from ev_core.compiling.code_store import can_be_kept
from ev_core.faults.row import FaultRow, of_signals
from ev_core.lockstep.configuration import Configuration
from ev_core.methods.part import CalledBack, Part, PythonPart
from ev_core.sensors.row import SensorRow
from ev_msgs_py.contract.frame import TIME, Frame
from ev_msgs_py.refusal import ParameterError


class Restart(CalledBack):
    """Puts a part back to its start at the instants at which it begins anew."""

    state = None  # it has none of its own

    def __init__(self, part: Any, ends: Collection[float], period: float) -> None:
        self._part = part
        self._period = period
        self._ends = ends
        self._first = copy.deepcopy(part.state)

    def before(self, time: float) -> None:
        """Put the part back before it answers at a time [s], if it begins anew there."""
        if round(time / self._period) in self._ends:
            self._part.state = copy.deepcopy(self._first)

    def start(self, there: Frame) -> None:
        """Do nothing: the part is at its start."""

    def step(self, here: Frame, there: Frame) -> None:
        """Put the part back: compiled code calls this before the part answers."""
        self.before(here.numbers[TIME])

    def notes(self) -> tuple[str, ...]:
        """No notes: the parameters show the restart."""
        return ()


class Sensed(CalledBack):
    """Steps a part; its sensors and then its faults replace the true numbers in its outputs.

    The part never sees their numbers. The state is that of the part, then those of the rows.
    """

    def __init__(
        self, part: Any, rows: Sequence[SensorRow | FaultRow], restart: Restart | None = None
    ) -> None:
        self.part, self.rows, self._restart = part, rows, restart

    @property
    def state(self) -> list[float]:
        """The numbers of the part, and those of its rows."""
        found: list[float] = [] if self.part.state is None else [*self.part.state]
        for row in self.rows:
            found += row.state
        return found

    @state.setter
    def state(self, row: list[float]) -> None:
        # From the end, since only the rows know how many numbers they have.
        place = len(row)
        for each in reversed(self.rows):
            begin = place - len(each.state)
            each.state = list(row[begin:place])
            place = begin
        if place:
            self.part.state = row[:place]

    def start(self, there: Frame) -> None:
        """Write the initial outputs as the rows change them."""
        self.part.start(there)
        for row in self.rows:
            row.start()
        self._show(there)

    def step(self, here: Frame, there: Frame) -> None:
        """One step of the part, and of its rows."""
        if self._restart is not None:
            self._restart.before(here.numbers[TIME])
        self.part.step(here, there)
        self._show(there)

    def _show(self, there: Frame) -> None:
        for row in self.rows:
            row.step(there.numbers)
        self.refuse_not_finite(there)

    def refuse_not_finite(self, there: Frame) -> None:
        """SignalError if a number that it shows is not finite."""
        self.part.refuse_not_finite(there)

    def notes(self) -> tuple[str, ...]:
        """Notes of the part."""
        notes: tuple[str, ...] = self.part.notes()
        return notes

    def go_on_from(self, other: Sensed) -> None:
        """Let each row go on where one of its kind was."""
        for row in self.rows:
            for before in other.rows:
                if type(row) is type(before):
                    row.go_on_from(before)


def part_of(configuration: Configuration, compiled: bool) -> Part:
    """A new part of a configuration, at rest, behind its sensors and faults.

    `compiled` asks for compiled code where the method can be compiled; laws that are too heavy for
    plain Python are compiled all the same.
    """
    return behind_sensors(configuration, method_part(configuration, compiled))


def behind_sensors(configuration: Configuration, part: Part) -> Part:
    """The part of a method behind the sensors and faults of its configuration."""
    rows = rows_of(configuration)
    return Sensed(part, rows, _restart(configuration, part)) if rows else part


def rows_of(configuration: Configuration) -> list[SensorRow | FaultRow]:
    """Rows that change the numbers of a part: its sensors, and then its faults."""
    rows: list[SensorRow | FaultRow] = []
    common = configuration.common
    if not configuration.is_ideal:
        rows.append(SensorRow(configuration.sensors, common.seed, common.vehicle.driven_wheels))
    if faults := of_signals(configuration.faults):
        rows.append(
            FaultRow(faults, configuration.method.writes, common.seed, common.control_period)
        )
    return rows


def restarts(configuration: Configuration) -> list[float]:
    """The instants, in control periods, at which the program of a role begins anew."""
    period = configuration.common.control_period
    found: set[float] = set()
    for fault in of_signals(configuration.faults):
        if fault.kind == "restarted":
            _, end = fault.periods(period)
            found.add(end)
    return sorted(found)


def _restart(configuration: Configuration, part: Part) -> Restart | None:
    ends = restarts(configuration)
    return Restart(part, ends, configuration.common.control_period) if ends else None


def is_kept(configuration: Configuration) -> bool:
    """Return whether the method is on disk as machine code."""
    method, common = configuration.method, configuration.common
    if method.law is None or not method.law.is_compilable:
        return False
    # Here and below: numba and what stands on it are slow to import, and not always needed.
    from ev_core.compiled import part

    return part.is_kept(method, configuration.given, common.vehicle, common.control_period)


def is_compiled(configuration: Configuration, may_wait: bool = True) -> bool:
    """Return whether a node runs a method compiled.

    Where it `may_wait`, it is compiled now, once for all. A method that cannot be compiled, and a
    light law without time to compile it, run in plain Python with the same bits. ParameterError if
    a law is too heavy for plain Python and there is no time to compile it.
    """
    law = configuration.method.law
    if law is None or not law.is_compilable:
        return False
    if is_kept(configuration):
        return True
    if not may_wait:
        if law.heavy:
            name = f"{configuration.role}={configuration.method.name}"
            raise ParameterError(
                f"{name} is not compiled, for which real time cannot wait: ev-stack compile {name}"
            )
        return False
    if not can_be_kept():
        return False
    # A law with a mistake runs in plain Python, which reports it when a step gets there. One that
    # prints becomes a part in plain Python here, with a note.
    with suppress(ParameterError):
        method_part(configuration, compiled=True)
        return True
    return False


def compiled_parts(configuration: Configuration) -> list[Any]:
    """Parts for the compiled loop, which calls one behind the other.

    They are restart, method's part, sensors and faults.
    """
    part = method_part(configuration, compiled=True)
    restart = _restart(configuration, part)
    before = [] if restart is None else [restart]
    return [*before, part, *row_parts(configuration)]


def row_parts(configuration: Configuration) -> list[Any]:
    """Compiled sensors and faults behind the method's part."""
    rows = rows_of(configuration)
    if rows:
        from ev_core.compiled.part import RowPart

        return [RowPart(row) for row in rows]
    return []


def method_part(configuration: Configuration, compiled: bool, like: Any = None) -> Any:
    """The part of the method alone, without sensors.

    A compiled one may be `like` that of the same method.
    """
    method = configuration.method
    law = method.law
    if law is None or not law.is_compilable or not (compiled or law.heavy):
        kind = getattr(method.factory, "part", PythonPart)
        return kind(method, configuration.create())
    from ev_core.compiled.part import NeedsPython

    try:
        return compiled_part(configuration, like)
    except NeedsPython as error:
        if law.heavy:
            raise
        return PythonPart(method, configuration.create(), str(error))


def compiled_part(configuration: Configuration, like: Any = None) -> Any:
    """The part of the method alone, compiled in any case."""
    from ev_core.compiled.part import CompiledPart

    common = configuration.common
    return CompiledPart(
        configuration.method, configuration.given, common.vehicle, common.control_period, like
    )


def hand_over(before: Part, after: Part, changed: Iterable[str] = ()) -> None:
    """Let a part go on with the state of another one of its method.

    Sensors and faults too where both have the same. ParameterError that names the `changed`
    parameters if the state has another length with them.
    """
    state = bare(before).state
    had = np.size(state)
    has = np.size(bare(after).state)
    if had != has:
        raise ParameterError(
            f"{', '.join(changed)}: a state of {had} numbers would have {has}, expected as many; "
            "a parameter that sets the length of the state is to be declared read_only"
        )
    bare(after).state = state
    if isinstance(before, Sensed) and isinstance(after, Sensed):
        after.go_on_from(before)


def bare(part: Part) -> Any:
    """The part of the method, without its sensors and faults."""
    return part.part if isinstance(part, Sensed) else part
