"""Feedback of the inverters as stock messages, and their diagnosis."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.node import Node
from sensor_msgs.msg import BatteryState, JointState, Temperature

from ev_control.inverter_gateway.diagnosis import diagnosis
from ev_control.inverter_gateway.state import Device
from ev_msgs_py.can.frames import DEVICES

NAMES = {"Drive11": "right_drive", "Drive12": "left_drive", "Load11": "right_load", "Load12": "left_load"}
_LEVELS = (DiagnosticStatus.OK, DiagnosticStatus.WARN, DiagnosticStatus.ERROR, DiagnosticStatus.STALE)
_QUEUE = 10


class FeedbackPublisher:
    """Publishes all four devices: motion often, the rest now and then, a diagnosis also when it changes."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._motion = node.create_publisher(JointState, "drive_states", _QUEUE)
        self._dc_links = {n: node.create_publisher(BatteryState, f"drives/{NAMES[n]}/dc_link", _QUEUE) for n in DEVICES}
        self._heat: dict[tuple[str, str], Any] = {
            (name, what): node.create_publisher(Temperature, f"drives/{NAMES[name]}/{what}_temperature", _QUEUE)
            for name in DEVICES
            for what in ("winding", "inverter")
        }
        self._diagnostics = node.create_publisher(DiagnosticArray, "/diagnostics", _QUEUE)
        self._said: list[tuple[int, str]] = []

    def publish_motion(self, devices: Mapping[str, Device]) -> None:
        """Torque and speed at the shafts of all devices."""
        message = JointState(name=[NAMES[name] for name in devices])
        message.header.stamp = self._now()
        message.velocity = [device.feedback.speed for device in devices.values()]
        message.effort = [device.feedback.torque for device in devices.values()]
        self._motion.publish(message)

    def publish_rest(self, devices: Mapping[str, Device]) -> None:
        """DC links and temperatures."""
        for name, device in devices.items():
            feedback = device.feedback
            link = BatteryState(voltage=feedback.dc_voltage, current=-feedback.dc_current)  # positive while it charges
            link.header.stamp = self._now()
            link.header.frame_id, link.present = NAMES[name], feedback.age < 1.0
            self._dc_links[name].publish(link)
            for what in ("winding", "inverter"):
                heat = Temperature(temperature=getattr(feedback, f"{what}_temperature"))
                heat.header = link.header
                self._heat[name, what].publish(heat)

    def diagnose(self, devices: Mapping[str, Device], feedback_timeout: float, anyway: bool) -> None:
        """Say how every device is, if it has changed or `anyway`."""
        found = {name: diagnosis(device, feedback_timeout) for name, device in devices.items()}
        said = [(each.level, each.message) for each in found.values()]
        if said == self._said and not anyway:
            return
        self._said = said
        report = DiagnosticArray()
        report.header.stamp = self._now()
        for name, each in found.items():
            status = DiagnosticStatus(level=_LEVELS[each.level], message=each.message, hardware_id=name)
            status.name = f"{self._node.get_fully_qualified_name()}: {NAMES[name]}"
            status.values = [KeyValue(key=key, value=value) for key, value in each.details.items()]
            report.status.append(status)
        self._diagnostics.publish(report)

    def _now(self) -> Any:
        return self._node.get_clock().now().to_msg()
