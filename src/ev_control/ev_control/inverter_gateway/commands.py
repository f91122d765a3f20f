"""Commands of the graph for the gateway: wheel torques for the drives, torques or speeds for the load machines."""

from __future__ import annotations

from collections.abc import Callable
from math import isfinite

from rclpy.node import Node
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import JointState

from ev_control.inverter_gateway.parameters import GatewayParameters
from ev_control.inverter_gateway.publishing import NAMES
from ev_control.inverter_gateway.station import GatewayStation
from ev_core.lockstep.stepper import WRITERS
from ev_core.nodes.reports import Reports
from ev_core.nodes.signal_io import Reader, SignalReader, Speaker
from ev_msgs_py.can.frames import LOADS, SPEED_MODE, TORQUE_MODE
from ev_msgs_py.contract.optional_signals import LoadCommand
from ev_msgs_py.contract.signals import WheelTorqueCommand
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.wire.layout import MessageError
from ev_msgs_py.wire.message_format import format_of

LOAD_COMMAND = "load_command"


class Commands:
    """Hands the newest command of each topic to the station; `reports` is told what is refused."""

    def __init__(
        self, node: Node, station: GatewayStation, parameters: Callable[[], GatewayParameters],
        reports: Reports,
    ) -> None:  # fmt: skip
        self._station, self._parameters, self._reports = station, parameters, reports
        self._torques = SignalReader(node, TOPICS[WheelTorqueCommand], self._take_torques, reports.note)
        speaker = Speaker(node, LOAD_COMMAND, WRITERS[LoadCommand], reports.note)
        self._loads = Reader(node, JointState, LOAD_COMMAND, self._take_loads, speaker)

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
            self._station.command(name, TORQUE_MODE, torques[WHEEL_NAMES.index(wheel)] / p.gear_ratio)

    def _take_loads(self, serialized: bytes) -> None:
        """One array is filled: effort [N m] for torque mode, or velocity [rad/s] for speed mode, at the shaft."""
        try:
            message = deserialize_message(serialized, JointState)
        except RuntimeError:
            message = JointState(name=["unreadable"])
        mode, values = (SPEED_MODE, message.velocity) if message.velocity else (TORQUE_MODE, message.effort)
        ours = {NAMES[name]: name for name in LOADS}
        wrong = set(message.name) - set(ours) or len(values) != len(message.name) or not all(map(isfinite, values))
        if wrong or (message.velocity and message.effort):
            self._reports.note(
                LOAD_COMMAND,
                f"{LOAD_COMMAND} ignored: needed are the names {', '.join(ours)} and either efforts or velocities",
            )
            return
        for name, value in zip(message.name, values, strict=True):
            self._station.command(ours[name], mode, value)
