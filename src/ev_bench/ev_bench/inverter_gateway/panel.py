"""ROS side of a gateway node: services, commands of the graph, feedback and its diagnosis.

How it works: `Commands` reads both topics of commands and hands the values to the station,
`FeedbackPublisher` publishes what the station has of its devices, and `Panel` has the services.

Commands are wheel torques for the drives, torques or speeds for the load machines; feedback goes
out as stock messages.
"""

from collections.abc import Callable, Mapping
from math import isfinite
from typing import Any, NamedTuple

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.node import Node
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import BatteryState, JointState, Temperature
from std_srvs.srv import SetBool, Trigger

from ev_bench.inverter_gateway.gateway import Device, GatewayParameters, latched, latched_names
from ev_bench.inverter_gateway.leading import is_faulty
from ev_bench.inverter_gateway.station import GatewayStation
from ev_core.lockstep.stepper import WRITERS
from ev_msgs_py.can.drive_states import STATE_NAMES
from ev_msgs_py.can.frames import DEVICES, DRIVES, LOADS, SPEED_MODE, TORQUE_MODE, WARNINGS, is_due
from ev_msgs_py.contract.optional_signals import LoadCommand
from ev_msgs_py.contract.signals import WheelTorqueCommand
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.wire import MessageError, format_of
from ev_nodes.stepping.reports import Reports
from ev_nodes.stepping.signal_io import OnePublisher, Reader, SignalReader

LOAD_COMMAND = "load_command"
NAMES = {
    "Drive11": "right_drive",
    "Drive12": "left_drive",
    "Load11": "right_load",
    "Load12": "left_load",
}
GOOD, WARNED, FAULTY, SILENT = range(4)  # places in _LEVELS
_LEVELS = (
    DiagnosticStatus.OK,
    DiagnosticStatus.WARN,
    DiagnosticStatus.ERROR,
    DiagnosticStatus.STALE,
)
_QUEUE = 10
_MOTION_CYCLE = 10.0  # ms
_REST_CYCLE = 100.0  # ms


class Diagnosis(NamedTuple):
    """Level, one line, and details by name."""

    level: int
    message: str
    details: dict[str, str]


def diagnosis(s: Device, feedback_timeout: float) -> Diagnosis:
    """The diagnosis of a device; a latched fault comes before everything else."""
    feedback = s.feedback
    state, faults = int(feedback.state), latched_names(latched(s))
    warned = [
        name for place, name in enumerate(WARNINGS) if int(feedback.warning_bits) >> place & 1
    ]
    details = {
        "state": STATE_NAMES[state],
        "faults": ", ".join(faults),
        "warnings": ", ".join(warned),
        "error_code": f"{int(feedback.error_code):04X}h",
        "feedback_age_s": f"{feedback.age:.4f}" if feedback.age < 1e6 else "never received",
        "frames_refused": f"{feedback.refused:.0f}",
        "frames_lost": f"{feedback.lost:.0f}",
        "dc_voltage_V": f"{feedback.dc_voltage:.3f}",
        "winding_temperature_degC": f"{feedback.winding_temperature:.1f}",
    }
    # The statusword may show a fault before the frame comes that names it.
    if faults or is_faulty(s):
        return Diagnosis(
            FAULTY, f"{STATE_NAMES[state]}: {', '.join(faults) or 'fault not yet named'}", details
        )
    if feedback.age > feedback_timeout:
        return Diagnosis(SILENT, "no valid feedback", details)
    if warned:
        return Diagnosis(WARNED, f"{STATE_NAMES[state]}: {', '.join(warned)}", details)
    return Diagnosis(GOOD, STATE_NAMES[state], details)


class FeedbackPublisher:
    """Publisher of all four devices: motion often, the rest at times, a diagnosis on changes."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._motion = node.create_publisher(JointState, "drive_states", _QUEUE)
        self._dc_links: dict[str, Any] = {}
        self._heat: dict[tuple[str, str], Any] = {}
        for name in DEVICES:
            topic = f"drives/{NAMES[name]}"
            self._dc_links[name] = node.create_publisher(BatteryState, f"{topic}/dc_link", _QUEUE)
            for what in ("winding", "inverter"):
                heat = node.create_publisher(Temperature, f"{topic}/{what}_temperature", _QUEUE)
                self._heat[name, what] = heat
        self._diagnostics = node.create_publisher(DiagnosticArray, "/diagnostics", _QUEUE)
        self._reported: list[tuple[int, str]] = []

    def publish_motion(self, devices: Mapping[str, Device]) -> None:
        """Publish torque and speed at the shafts of all devices."""
        message = JointState(name=[NAMES[name] for name in devices])
        message.header.stamp = self._now()
        message.velocity = [device.feedback.speed for device in devices.values()]
        message.effort = [device.feedback.torque for device in devices.values()]
        self._motion.publish(message)

    def publish_rest(self, devices: Mapping[str, Device]) -> None:
        """Publish DC links and temperatures."""
        for name, device in devices.items():
            feedback = device.feedback
            link = BatteryState(
                voltage=feedback.dc_voltage, current=-feedback.dc_current
            )  # positive while it charges
            link.header.stamp = self._now()
            link.header.frame_id, link.present = NAMES[name], feedback.age < 1.0
            self._dc_links[name].publish(link)
            for what in ("winding", "inverter"):
                heat = Temperature(temperature=getattr(feedback, f"{what}_temperature"))
                heat.header = link.header
                self._heat[name, what].publish(heat)

    def diagnose(
        self, devices: Mapping[str, Device], feedback_timeout: float, anyway: bool
    ) -> None:
        """Publish the diagnosis of all devices, if it has changed or `anyway`."""
        found = {name: diagnosis(device, feedback_timeout) for name, device in devices.items()}
        reported = [(each.level, each.message) for each in found.values()]
        # By level and line: details such as ages change with every cycle.
        if reported == self._reported and not anyway:
            return
        self._reported = reported
        report = DiagnosticArray()
        report.header.stamp = self._now()
        for name, each in found.items():
            status = DiagnosticStatus(
                level=_LEVELS[each.level], message=each.message, hardware_id=name
            )
            status.name = f"{self._node.get_fully_qualified_name()}: {NAMES[name]}"
            status.values = [KeyValue(key=key, value=value) for key, value in each.details.items()]
            report.status.append(status)
        self._diagnostics.publish(report)

    def _now(self) -> Any:
        return self._node.get_clock().now().to_msg()


class Commands:
    """Hands the newest command of each topic to the station; `reports` is given what is refused."""

    def __init__(
        self, node: Node, station: GatewayStation, parameters: Callable[[], GatewayParameters],
        reports: Reports,
    ) -> None:  # fmt: skip
        self._station = station
        self._parameters = parameters
        self._reports = reports
        self._torques = SignalReader(node, TOPICS[WheelTorqueCommand], self._take_torques, reports)
        judge = OnePublisher(node, LOAD_COMMAND, WRITERS[LoadCommand], reports)
        self._loads = Reader(node, JointState, LOAD_COMMAND, self._take_loads, judge)

    def take(self) -> bool:
        """Take all that has come; False if there was nothing."""
        progressed = False
        for reader in (self._torques, self._loads):
            while (message := reader.take()) is not None:
                reader.receive(message)
                progressed = True
        return progressed

    def _take_torques(self, message: bytes) -> None:
        """Torque at the shaft is torque at the wheel over the gear ratio."""
        try:
            _, torques = format_of(WheelTorqueCommand).read(message)
        except MessageError as error:
            self._reports.note("torque_command", f"torque_command ignored: {error}")
            return
        p = self._parameters()
        for name, wheel in (("Drive11", p.wheel_11), ("Drive12", p.wheel_12)):
            self._station.command(
                name, TORQUE_MODE, torques[WHEEL_NAMES.index(wheel)] / p.gear_ratio
            )

    def _take_loads(self, serialized: bytes) -> None:
        """Take efforts [N m] for torque mode or velocities [rad/s] for speed mode at shafts."""
        try:
            message = deserialize_message(serialized, JointState)
        except RuntimeError:
            # An unknown name is refused below, with the line for all that cannot be used.
            message = JointState(name=["unreadable"])
        mode, values = TORQUE_MODE, message.effort
        if message.velocity:
            mode, values = SPEED_MODE, message.velocity
        ours = {NAMES[name]: name for name in LOADS}
        unknown = set(message.name) - set(ours)
        is_whole = len(values) == len(message.name) and all(map(isfinite, values))
        both = message.velocity and message.effort
        if unknown or not is_whole or both:
            self._reports.note(
                LOAD_COMMAND,
                f"{LOAD_COMMAND} ignored: needed are the names {', '.join(ours)} and either "
                f"efforts or velocities",
            )
            return
        for name, value in zip(message.name, values, strict=True):
            self._station.command(ours[name], mode, value)


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
            response.success = True
            response.message = "all devices are being disabled"
            return response
        timeout = station.p.command_timeout
        commanded = [n for n in DEVICES if station.devices[n].command_age <= timeout]
        # Without any command the drives are asked for, which gives the reason why not.
        refused = station.enable(tuple(commanded or DRIVES))
        response.success = not refused
        response.message = refused or f"being enabled: {', '.join(commanded)}"
        return response

    def _reset(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._station().reset()
        response.success = True
        response.message = "the reset sequence has begun; everything is disabled"
        return response
