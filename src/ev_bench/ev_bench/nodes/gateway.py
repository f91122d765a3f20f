"""Node of the gateway between the graph and the inverters on a CAN bus."""

from typing import Any

from ev_bench.bus.channel import Channels
from ev_bench.inverter_gateway.gateway import GatewayParameters
from ev_bench.inverter_gateway.panel import Commands, Panel
from ev_bench.inverter_gateway.station import GatewayOnBus, GatewayStation
from ev_bench.nodes.bus_nodes import BusNode, RoleOnBus
from ev_core.lockstep.configuration import Configuration
from ev_core.lockstep.holding import HoldingInbox
from ev_msgs_py.can.frame_length import Frame
from ev_msgs_py.contract.signals import WheelTorqueCommand
from ev_nodes.run_role import given_parameters, make_node, run_node

_ROLE, _METHOD = "inverter_gateway", "can"


class InverterGatewayNode(BusNode):
    """Node that leads the inverters by the wall clock and publishes their feedback."""

    def __init__(self, **node_arguments: Any) -> None:
        super().__init__(_ROLE, GatewayParameters, **node_arguments)

    def prepare(self) -> None:
        """Make the station, its subscriptions and its publishers."""
        self.station = GatewayStation(self.database, self.parameters)
        self._commands = Commands(self, self.station, lambda: self.parameters, self.reports)
        self._panel = Panel(self, lambda: self.station)

    def changed(self) -> None:
        """Go on with other limits and time-outs."""
        self.station.change(self.parameters)

    def poll(self) -> bool:
        """Take commands, then frames, then make a cycle if one is due."""
        return self.channels is not None and (self._commands.take() | super().poll())

    def take(self, circuit: str, frame: Frame) -> None:
        """Take feedback; frames for other devices are left alone."""
        self.station.receive(circuit, frame)

    def cycle(self, ticks: int) -> list[tuple[str, Frame]]:
        """Lead the inverters one cycle on, and publish what is due."""
        before = self.station.s.tick
        frames = self.station.step(ticks)
        self._panel.publish_due(before, before + ticks)
        return frames


class GatewayRoleOnBus(RoleOnBus):
    """Plays the role of a run in real time, over the same bus."""

    def __init__(self, **node_arguments: Any) -> None:
        super().__init__(_ROLE, **node_arguments)
        self._panel = Panel(self, lambda: self.player.station)

    def played_by(self, configuration: Configuration) -> GatewayOnBus:
        """Make a gateway that leads nothing yet."""
        return GatewayOnBus(configuration, self._newest)

    def _newest(self) -> int:
        """Stamp of the newest torque command."""
        inbox = self.stepper.inbox
        assert isinstance(inbox, HoldingInbox), "it plays in real time"
        return inbox.held.stamp_of(WheelTorqueCommand)

    def open_channels(self) -> Channels:
        """Open the channels of its parameters, with their log."""
        bus = self.configuration.parameters.bus
        return Channels(bus, bus.log)

    def cycle(self, ticks: int) -> list[tuple[str, Frame]]:
        """Lead the inverters one cycle on, and publish what is due."""
        before = self.player.station.s.tick
        frames = super().cycle(ticks)
        self._panel.publish_due(before, before + ticks)
        return frames


def make(**node_arguments: Any) -> Any:
    """Make the node: of a role in lockstep or real time, or without a graph."""
    with given_parameters(_ROLE, **node_arguments) as given:
        if given.get("mode") == "realtime" and given.get("method", _METHOD) == _METHOD:
            return GatewayRoleOnBus(**node_arguments)
        in_graph = "method" in given or given.get("mode") == "lockstep"
        return (
            make_node(_ROLE, **node_arguments)
            if in_graph
            else InverterGatewayNode(**node_arguments)
        )


def main() -> None:
    """ros2 run ev_bench inverter_gateway"""
    run_node(_ROLE, make)
