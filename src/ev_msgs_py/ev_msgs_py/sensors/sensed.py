"""A part behind its sensors, for nodes: where truth and measurement part (docs/sensors.md)."""

from __future__ import annotations

from typing import Any

from ev_msgs_py.contract.frame import Frame
from ev_msgs_py.sensors.row import SensorRow


class Sensed:
    """Steps a part, and lets its sensors put what they show into the place of the true numbers.

    The part never sees what they show. The state is that of the part, then that of the sensors.
    """

    def __init__(self, part: Any, parameters: Any, seed: int) -> None:
        self.part = part
        self.sensors = SensorRow(parameters, seed)

    @property
    def state(self) -> list[float]:
        """The numbers of the part, and those of its sensors."""
        return [*self.part.state, *self.sensors.state]

    @state.setter
    def state(self, row: list[float]) -> None:
        count = len(self.part.state)
        self.part.state, self.sensors.state = row[:count], list(row[count:])

    def start(self, there: Frame) -> None:
        """Write what the sensors show of the initial outputs."""
        self.part.start(there)
        self.sensors.start()
        self._measure(there)

    def step(self, here: Frame, there: Frame) -> None:
        """One step of the part, and of its sensors."""
        self.part.step(here, there)
        self._measure(there)

    def _measure(self, there: Frame) -> None:
        self.sensors.step(there.numbers)
        self.part.refuse_not_finite(there)

    def notes(self) -> tuple[str, ...]:
        """What the part notes."""
        notes: tuple[str, ...] = self.part.notes()
        return notes
