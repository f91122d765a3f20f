"""The gateway between the graph and the inverters on a CAN bus."""

from __future__ import annotations

from typing import Any

from std_srvs.srv import SetBool, Trigger

from ev_control.inverter_gateway.commands import Commands
from ev_control.inverter_gateway.parameters import GatewayParameters
from ev_control.inverter_gateway.publishing import FeedbackPublisher
from ev_control.inverter_gateway.station import GatewayStation
from ev_msgs_py.can.channel import Frame
from ev_msgs_py.can.frames import DEVICES, DRIVES
from ev_msgs_py.can.schedule import is_due
from ev_msgs_py.nodes.bus_node import BusNode, on_bus_or_in_graph
from ev_msgs_py.nodes.run_role import run_node

_MOTION_CYCLE, _REST_CYCLE = 10.0, 100.0  # ms


class InverterGatewayNode(BusNode):
    """Sends what `torque_command` and `load_command` say, by the wall clock; publishes what the inverters answer."""

    def __init__(self, **node_arguments: Any) -> None:
        super().__init__("inverter_gateway", GatewayParameters, **node_arguments)
        self.create_service(SetBool, "inverter_gateway/enable", self._enable)
        self.create_service(Trigger, "inverter_gateway/reset", self._reset)

    def prepare(self) -> None:
        """What leads the inverters, what hears the graph, what speaks to it."""
        self.station = GatewayStation(self.database, self.parameters)
        self._commands = Commands(self, self.station, lambda: self.parameters, self.reports)
        self._feedback = FeedbackPublisher(self, self.station.devices)

    def changed(self) -> None:
        """Go on with other limits and time-outs."""
        self.station.change(self.parameters)

    def poll(self) -> bool:
        """Take commands, then frames, then make a cycle if one is due."""
        return self.channels is not None and (self._commands.take() | super().poll())

    def take(self, circuit: str, frame: Frame) -> None:
        """Feedback, or frames for others."""
        self.station.receive(circuit, frame)

    def cycle(self, ticks: int) -> list[tuple[str, Frame]]:
        """Lead the inverters one cycle on, and publish what is due."""
        before = self.station.s.tick
        frames = self.station.step(ticks)
        rest = is_due(_REST_CYCLE, before, before + ticks)
        if rest:
            self._feedback.publish_rest()
        if is_due(_MOTION_CYCLE, before, before + ticks):
            self._feedback.publish_motion()
            self._feedback.diagnose(self.parameters.feedback_timeout, anyway=rest)
        return frames

    def _enable(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        """Enable every device that has had a command, or disable all."""
        if not request.data:
            self.station.disable()
            response.success, response.message = True, "all devices are being disabled"
            return response
        commanded = [name for name in DEVICES if self.station.devices[name].command_age <= self._command_timeout]
        refused = self.station.enable(tuple(commanded or DRIVES))
        response.success = not refused
        response.message = refused or f"being enabled: {', '.join(commanded)}"
        return response

    def _reset(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self.station.reset()
        response.success, response.message = True, "the reset sequence has begun; everything is disabled"
        return response

    @property
    def _command_timeout(self) -> float:
        return float(self.parameters.command_timeout)


def main() -> None:
    """ros2 run ev_control inverter_gateway"""
    run_node("inverter_gateway", lambda: on_bus_or_in_graph("inverter_gateway", InverterGatewayNode))
