"""The gateway without ROS, bus and clock: frames and commands in, one cycle, frames out."""

from __future__ import annotations

from math import isfinite
from typing import Any

from ev_control.inverter_gateway.hearing import Hearing
from ev_control.inverter_gateway.leading import (
    advance_device,
    begin_reset,
    controlword,
    is_faulty,
    may_turn,
)
from ev_control.inverter_gateway.parameters import BOTH, GatewayParameters
from ev_control.inverter_gateway.state import Device, Gateway
from ev_msgs_py.can.bus_parameters import CIRCUITS
from ev_msgs_py.can.channel import Frame
from ev_msgs_py.can.conventions import RPM, TORQUE_MODE
from ev_msgs_py.can.database import Database
from ev_msgs_py.can.protection import next_counter
from ev_msgs_py.can.schedule import TICK, is_due
from ev_msgs_py.lockstep.law import namespace
from ev_msgs_py.parameters.declaration import number_tree

DRIVES, LOADS = ("Drive11", "Drive12"), ("Load11", "Load12")
DEVICES = (*DRIVES, *LOADS)


class GatewayStation:
    """Leads four inverters on two channels; `devices` are their states by name."""

    def __init__(self, database: Database, parameters: GatewayParameters) -> None:
        self.s = Gateway()
        self.change(parameters)
        self.devices: dict[str, Device] = {
            "Drive11": self.s.drive_11, "Drive12": self.s.drive_12, "Load11": self.s.load_11, "Load12": self.s.load_12
        }  # fmt: skip
        self._hearing = {name: Hearing(database, name, device.feedback) for name, device in self.devices.items()}
        self._set_points = {name: database[f"{name}_SetPoint"] for name in DEVICES}
        self._heartbeat = database["Ecu_Heartbeat"]

    def change(self, parameters: GatewayParameters) -> None:
        """Go on with other limits and time-outs."""
        self.p: Any = namespace(number_tree(parameters))

    def receive(self, circuit: str, frame: Frame) -> None:
        """Take a frame from the channel of a circuit."""
        for name in DEVICES:
            if name.endswith(circuit):
                self._hearing[name].receive(frame)

    def command(self, name: str, mode: int, value: float) -> None:
        """What a device shall do: a torque [N m] or a speed [rad/s] at its shaft; ValueError for what is no number."""
        if not isfinite(value):
            raise ValueError(f"command of {name}: {value} is refused, allowed is a finite number")
        device = self.devices[name]
        device.mode, device.command_age = float(mode), 0.0
        device.torque, device.speed = (value, self.p.speed_limit) if mode == TORQUE_MODE else (0.0, value)

    def enable(self, names: tuple[str, ...]) -> str:
        """Begin to enable devices, or say in one line why none of them is."""
        for name in names:
            device = self.devices[name]
            if is_faulty(device):
                return f"{name} has a latched fault: reset it first"
            if device.feedback.age > self.p.feedback_timeout:
                return f"{name} says nothing: no valid feedback within {self.p.feedback_timeout:g} s"
            if device.command_age > self.p.command_timeout:
                return f"{name} has no command: none came within {self.p.command_timeout:g} s"
        for name in names:
            self.devices[name].enable = 1.0
        return ""

    def disable(self) -> None:
        """Take torque and voltage from everything."""
        for device in self.devices.values():
            device.enable = 0.0

    def reset(self) -> None:
        """Begin the reset sequence of everything; nothing is enabled after it."""
        for device in self.devices.values():
            begin_reset(device)

    def step(self, ticks: int = 1) -> list[tuple[str, Frame]]:
        """Advance by some cycles of 1 ms, after the frames of this cycle; what is to be sent, each with its circuit."""
        before = int(self.s.tick)
        for name, device in self.devices.items():
            self._hearing[name].end_cycle()
            advance_device(self.p, device, ticks * TICK)
        if self.p.fault_stops == BOTH and any(is_faulty(self.devices[name]) for name in DRIVES):
            for name in DRIVES:
                self.devices[name].enable = 0.0
        self.s.tick += ticks
        frames = [(name[-2:], self._set_point(name)) for name in DEVICES]
        if is_due(self._heartbeat.cycle, before, before + ticks):
            frames += [(circuit, self._life_sign(place)) for place, circuit in enumerate(CIRCUITS)]
        return frames

    def _set_point(self, name: str) -> Frame:
        layout, device = self._set_points[name], self.devices[name]
        most = self.p.torque_limit if name in DRIVES else self.p.load_torque_limit
        turns = may_turn(device)
        values = {
            "Mode": device.mode,
            "Direction": 0.0,
            "Controlword": float(controlword(device)),
            "Torque": min(max(device.torque, -most), most) if turns else 0.0,
            "Speed": device.speed / RPM if turns else 0.0,
            "TorqueLimit": most if turns else 0.0,
        }
        data = layout.pack(values, int(device.counter))
        device.counter = float(next_counter(int(device.counter)))
        return Frame(layout.identifier, data)

    def _life_sign(self, place: int) -> Frame:
        values = {"CommandStale": max(device.command_stale for device in self.devices.values())}
        for name, device in self.devices.items():
            values[f"Stale{name}"], values[f"Enable{name}"] = device.stale, device.enable
        counter = int(self.s.heartbeat_counters[place])
        self.s.heartbeat_counters[place] = float(next_counter(counter))
        return Frame(self._heartbeat.identifier, self._heartbeat.pack(values, counter))
