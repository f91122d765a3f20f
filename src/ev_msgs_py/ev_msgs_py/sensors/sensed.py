"""A part behind its sensors, for nodes: where truth and measurement part (docs/sensors.md)."""

from __future__ import annotations

from typing import Any

from ev_msgs_py.contract.frame import Frame
from ev_msgs_py.sensors.row import SensorRow


class Sensed:
    """Steps a part, and lets its sensors put what they show into the place of the true numbers.

    The part never sees what they show. Its state is that of the part and then that of the sensors.
    """

    def __init__(self, part: Any, sensors: Any, seed: int) -> None:
        self._part = part
        self._sensors = SensorRow(sensors, seed)

    @property
    def state(self) -> tuple[Any, list[float]]:
        """What lasts of the part, and of its sensors."""
        return self._part.state, self._sensors.state

    @state.setter
    def state(self, state: tuple[Any, list[float]]) -> None:
        self._part.state, sensors = state
        if len(sensors) == len(self._sensors.state):  # other delays: what is under way is not theirs
            self._sensors.state = list(sensors)

    def start(self, there: Frame) -> None:
        """Write what the sensors show of the initial outputs."""
        self._part.start(there)
        self._sensors.start()
        self._measure(there)

    def step(self, here: Frame, there: Frame) -> None:
        """One step of the part, and of its sensors."""
        self._part.step(here, there)
        self._measure(there)

    def _measure(self, there: Frame) -> None:
        self._sensors.step(there.numbers)
        self._part.refuse_not_finite(there)

    def notes(self) -> tuple[str, ...]:
        """What the part notes."""
        return self._part.notes()
