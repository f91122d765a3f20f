"""An object that integrates, behind its sensors: where truth and measurement part (docs/sensors.md)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ev_msgs_py.quantities import QUANTITIES, Quantity
from ev_msgs_py.sensor import Sensor


def behind_sensors(integrating: Any, sensors: Any, seed: int) -> Any:
    """The object behind those of its sensors that are not ideal; the object itself if all are.

    `sensors` are parameters as `quantities.sensors_for` declares them. A signal without a sensor stays true.
    """
    parameters = {q: getattr(sensors, q.name) for q in QUANTITIES if hasattr(sensors, q.name)}
    imperfect = [(q, Sensor(p, seed, q.name)) for q, p in parameters.items() if p != type(p)()]
    return Measured(integrating, imperfect) if imperfect else integrating


class Measured:
    """Shows what sensors show of an object that integrates, and is that object in everything else.

    Its state is never touched: sensors stand between the object and the topics. They measure once per period, however
    often `outputs` is called, and begin anew with the first one.
    """

    row = None  # that of the object would be the truth

    def __init__(self, integrating: Any, sensors: Sequence[tuple[Quantity, Sensor]]) -> None:
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
            signals = {type(signal): signal for signal in self._true.outputs()}
            for quantity, sensor in self._sensors:
                signal = signals[quantity.signal]
                signals[quantity.signal] = quantity.written(signal, sensor.measure(quantity.read(signal)))
            self._shown = tuple(signals.values())
        return self._shown

    def advance(self, *inputs: Any) -> None:
        """Integrate to the next instant."""
        self._true.advance(*inputs)
        self._shown = None
