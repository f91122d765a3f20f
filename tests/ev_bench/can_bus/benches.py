"""A circuit of the bench without bus and clock, and a controller frame by frame."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from can_bus.databases import ours

from ev_bench.inverter.circuit_station import CircuitStation
from ev_bench.inverter.device import CircuitParameters
from ev_core.parameters.values import build
from ev_msgs_py.can.drive_states import OPERATION_ENABLED, controlword_towards_operation, state_of
from ev_msgs_py.can.frame_length import Frame
from ev_msgs_py.can.payload import next_counter

TICK = 0.001
TORQUE_MODE, SPEED_MODE = 1.0, 2.0
NOTHING = {
    "Mode": 0.0,
    "Direction": 0.0,
    "Controlword": 0.0,
    "Torque": 0.0,
    "Speed": 0.0,
    "TorqueLimit": 0.0,
}
TORQUE = NOTHING | {"Mode": TORQUE_MODE, "Speed": 7500.0, "TorqueLimit": 400.0}
SPEED = NOTHING | {"Mode": SPEED_MODE, "TorqueLimit": 400.0}


class Bench:
    """The right circuit; `received` holds the newest values of each frame that it sends."""

    def __init__(self, **values: Any) -> None:
        self.station = CircuitStation(ours(), "11", build(CircuitParameters, values))
        self.circuit = self.station.s
        self.received: dict[str, dict[str, float]] = {}
        self.counters: dict[str, int] = {}
        # set-points that are repeated in every cycle, by device
        self.kept: dict[str, dict[str, float]] = {}
        self._by_identifier = {layout.identifier: layout for layout in ours()}

    def inverter(self, device: str) -> Any:
        return self.circuit.drive if device == "Drive11" else self.circuit.load

    def frame(self, device: str, values: Mapping[str, float]) -> Frame:
        layout = ours()[f"{device}_SetPoint"]
        counter = self.counters[device] = next_counter(self.counters.get(device, 14))
        return Frame(layout.identifier, layout.pack(values, counter))

    def send(self, device: str, **values: float) -> None:
        """One set-point with these signals."""
        self.station.receive(self.frame(device, NOTHING | values))

    def step(self, ticks: int = 1) -> None:
        for _ in range(ticks):
            for frame in self.station.step():
                layout = self._by_identifier[frame.identifier]
                self.received[layout.name] = layout.values(int.from_bytes(frame.data, "little"))

    def cycle(self, device: str = "Drive11", ticks: int = 1, **values: float) -> None:
        """Some cycles with the same set-point."""
        for _ in range(ticks):
            for other, kept in self.kept.items():
                self.send(other, **kept)
            self.send(device, **values)
            self.step()

    def state(self, device: str = "Drive11") -> int:
        """State in the statusword of a device."""
        return state_of(int(self.received[f"{device}_Motion"]["Statusword"]))

    def enable(self, device: str = "Drive11", **values: float) -> None:
        """Lead it to operation enabled by its statusword."""
        self.cycle(device, 3)
        for _ in range(3000):
            if self.state(device) == OPERATION_ENABLED:
                return
            word = float(controlword_towards_operation(self.state(device)))
            self.cycle(device, **(TORQUE | values | {"Controlword": word}))
        raise AssertionError("operation was not enabled")
