"""The inverters of both circuits with their machines, on a CAN bus."""

from __future__ import annotations

from typing import Any

from ev_core.bus.channel import Frame
from ev_core.bus.parameters import CIRCUITS
from ev_core.nodes.bus_nodes import BusNode
from ev_core.run_role import run_node
from ev_sim.inverter.circuit_station import CircuitStation
from ev_sim.inverter.device import InverterNodeParameters, inject


class InverterNode(BusNode):
    """Answers set-points with torque, speed and the rest; the parameters inject.* put faults in."""

    def __init__(self, **node_arguments: Any) -> None:
        super().__init__("inverter", InverterNodeParameters, **node_arguments)

    def prepare(self) -> None:
        """The two circuits, at rest."""
        self.circuits = {name: CircuitStation(self.database, name, self.parameters) for name in CIRCUITS}
        self.changed()

    def changed(self) -> None:
        """Go on with other parameters; the state lasts."""
        for name, circuit in self.circuits.items():
            circuit.change(self.parameters)
            inject(circuit.s.drive.injected, getattr(self.parameters.inject, f"drive_{name}"))
            inject(circuit.s.load.injected, getattr(self.parameters.inject, f"load_{name}"))

    def take(self, circuit: str, frame: Frame) -> None:
        """Set-points, or frames for others."""
        self.circuits[circuit].receive(frame)

    def cycle(self, ticks: int) -> list[tuple[str, Frame]]:
        """Advance everything; the frames of the inverters."""
        return [(name, frame) for name, circuit in self.circuits.items() for frame in circuit.step(ticks)]


def main() -> None:
    """ros2 run ev_sim inverter"""
    run_node("inverter", InverterNode)
