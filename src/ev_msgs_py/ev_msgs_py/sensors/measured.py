"""An object that integrates, behind its sensors: where truth and measurement part (docs/sensors.md)."""

from __future__ import annotations

from typing import Any

from ev_msgs_py.contract import frame
from ev_msgs_py.sensors.row import SensorRow, imperfect
from ev_msgs_py.shape import shape_of
from ev_msgs_py.topics import TOPICS


def behind_sensors(integrating: Any, sensors: Any, seed: int) -> Any:
    """The object behind those of its sensors that are not ideal; the object itself if all are.

    `sensors` are parameters as `quantities.sensors_for` declares them. A signal without a sensor stays true.
    """
    return Measured(integrating, SensorRow(sensors, seed)) if any(imperfect(sensors)) else integrating


class Measured:
    """Shows what sensors show of an object that integrates, and is that object in everything else.

    Its state is never touched: sensors stand between the object and the topics. They measure once per period, however
    often `outputs` is called, and begin anew with the first one.
    """

    row = None  # that of the object would be the truth

    def __init__(self, integrating: Any, sensors: SensorRow) -> None:
        self._true = integrating
        self._sensors = sensors
        self._shown: tuple[Any, ...] | None = None

    def __getattr__(self, name: str) -> Any:
        return getattr(self._true, name)

    @property
    def state(self) -> Any:
        """The state of the object."""
        return self._true.state

    @state.setter
    def state(self, state: Any) -> None:
        self._true.state = state

    def outputs(self) -> tuple[Any, ...]:
        """The signals of this instant as the sensors show them."""
        if self._shown is None:
            signals = self._true.outputs()
            numbers = [0.0] * frame.SIZE
            for signal in signals:
                numbers[frame.PLACES[type(signal)]] = TOPICS[type(signal)].codec.numbers(signal)
            self._sensors.step(numbers)
            kinds = map(type, signals)
            self._shown = tuple(shape_of(kind).signal_of(tuple(numbers[frame.PLACES[kind]])) for kind in kinds)
        return self._shown

    def advance(self, *inputs: Any) -> None:
        """Integrate to the next instant."""
        self._true.advance(*inputs)
        self._shown = None
