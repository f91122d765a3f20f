"""What a gateway node offers around its bus: the services, and what it publishes of its devices."""

from __future__ import annotations

from collections.abc import Callable

from rclpy.node import Node
from std_srvs.srv import SetBool, Trigger

from ev_control.inverter_gateway.publishing import FeedbackPublisher
from ev_control.inverter_gateway.station import GatewayStation
from ev_msgs_py.can.frames import DEVICES, DRIVES, is_due

_MOTION_CYCLE, _REST_CYCLE = 10.0, 100.0  # ms


class Panel:
    """Services and publishers of a node for its `station`."""

    def __init__(self, node: Node, station: Callable[[], GatewayStation]) -> None:
        self._station = station
        self._feedback = FeedbackPublisher(node)
        node.create_service(SetBool, "inverter_gateway/enable", self._enable)
        node.create_service(Trigger, "inverter_gateway/reset", self._reset)

    def publish_due(self, before: float, now: float) -> None:
        """Publish what is due between two ticks."""
        station = self._station()
        rest = is_due(_REST_CYCLE, before, now)
        if rest:
            self._feedback.publish_rest(station.devices)
        if is_due(_MOTION_CYCLE, before, now):
            self._feedback.publish_motion(station.devices)
            self._feedback.diagnose(station.devices, station.p.feedback_timeout, anyway=rest)

    def _enable(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        """Enable every device that has had a command, or disable all."""
        station = self._station()
        if not request.data:
            station.disable()
            response.success, response.message = True, "all devices are being disabled"
            return response
        commanded = [name for name in DEVICES if station.devices[name].command_age <= station.p.command_timeout]
        refused = station.enable(tuple(commanded or DRIVES))
        response.success = not refused
        response.message = refused or f"being enabled: {', '.join(commanded)}"
        return response

    def _reset(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._station().reset()
        response.success, response.message = True, "the reset sequence has begun; everything is disabled"
        return response
