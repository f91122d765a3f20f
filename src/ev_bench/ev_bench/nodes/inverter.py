"""The inverters of both circuits with their machines, on a CAN bus or in the bench's node."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from ev_bench.bus.channel import BusMeter, Channels
from ev_bench.bus.parameters import CIRCUITS
from ev_bench.inverter.circuit_station import CircuitStation
from ev_bench.inverter.device import InverterNodeParameters, inject
from ev_bench.machines.bench_on_bus import BenchOnBus, meters_of
from ev_bench.nodes.bus_nodes import BusNode, RoleOnBus
from ev_core.lockstep.configuration import Configuration
from ev_msgs_py.can.frame_length import Frame
from ev_nodes.run_role import run_node


class InverterNode(BusNode):
    """Answers set-points with torque, speed and the rest; the parameters inject.* put faults in."""

    def __init__(self, **node_arguments: Any) -> None:
        super().__init__("inverter", InverterNodeParameters, **node_arguments)

    def prepare(self) -> None:
        """The two circuits, at rest."""
        self.circuits = {
            name: CircuitStation(self.database, name, self.parameters) for name in CIRCUITS
        }
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
        return [
            (name, frame)
            for name, circuit in self.circuits.items()
            for frame in circuit.step(ticks)
        ]


class OnBus(RoleOnBus):
    """A base before that of the node: its bench has its inverters on the bus."""

    _meters: Mapping[str, BusMeter] = MappingProxyType({})

    def played_by(self, configuration: Configuration) -> BenchOnBus:
        """A bench at rest."""
        return BenchOnBus(configuration, self._meters_of(configuration))

    def open_channels(self) -> Channels:
        """Those of its parameters, with meters; the log is the gateway's."""
        return Channels(
            self.configuration.parameters.bus, meters=self._meters_of(self.configuration)
        )

    def _meters_of(self, configuration: Configuration) -> Mapping[str, BusMeter]:
        if not self._meters:
            self._meters = meters_of(configuration.parameters.bus.database)
        return self._meters


def main() -> None:
    """ros2 run ev_bench inverter"""
    run_node("inverter", InverterNode)
