"""A part behind its sensors and faults, for nodes: where truth and what others get part (docs/sensors.md)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ev_msgs_py.contract.frame import TIME, Frame
from ev_msgs_py.faults.restart import Restart
from ev_msgs_py.faults.row import FaultRow
from ev_msgs_py.lockstep.part import CalledBack
from ev_msgs_py.sensors.row import SensorRow


class Sensed(CalledBack):
    """Steps a part, and lets its sensors and then its faults put what they show into the place of the true numbers.

    The part never sees what they show. The state is that of the part, then those of the rows.
    """

    def __init__(self, part: Any, rows: Sequence[SensorRow | FaultRow], restart: Restart | None = None) -> None:
        self.part, self.rows, self._restart = part, rows, restart

    @property
    def state(self) -> list[float]:
        """The numbers of the part, and those of its rows."""
        of_part = () if self.part.state is None else self.part.state
        return [*of_part, *(number for row in self.rows for number in row.state)]

    @state.setter
    def state(self, row: list[float]) -> None:
        place = len(row)
        for each in reversed(self.rows):
            begin = place - len(each.state)
            each.state, place = list(row[begin:place]), begin
        if place:
            self.part.state = row[:place]

    def start(self, there: Frame) -> None:
        """Write what the rows show of the initial outputs."""
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
        self.part.refuse_not_finite(there)

    def notes(self) -> tuple[str, ...]:
        """What the part notes."""
        notes: tuple[str, ...] = self.part.notes()
        return notes

    def go_on_from(self, other: Sensed) -> None:
        """Let each row go on where one of its kind was."""
        for row in self.rows:
            for before in other.rows:
                if type(row) is type(before):
                    row.go_on_from(before)
