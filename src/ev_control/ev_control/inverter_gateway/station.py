"""The gateway without ROS, bus and clock: frames and commands in, one cycle, frames out."""

from __future__ import annotations

from math import isfinite
from typing import Any

from ev_control.inverter_gateway.hearing import receive_feedback
from ev_control.inverter_gateway.leading import (
    DOUBTFUL,
    LATCHED,
    MAY_BE_ENABLED,
    SILENT,
    WITHOUT_COMMAND,
    advance_gateway,
    begin_reset,
    command_device,
    refusal,
)
from ev_control.inverter_gateway.parameters import GatewayParameters
from ev_control.inverter_gateway.sending import heartbeat, set_point
from ev_control.inverter_gateway.state import Device, Gateway
from ev_core.bus.channel import Frame
from ev_core.bus.parameters import CIRCUITS
from ev_core.methods.law import namespace
from ev_core.parameters.declaration import number_tree
from ev_msgs_py.can.database import Database
from ev_msgs_py.can.frames import DEVICES, DRIVES, SENT, TICK, DeviceFrames, bench_frames, is_due


class GatewayStation:
    """Leads four inverters on two channels; `devices` are their states by name."""

    def __init__(self, database: Database, parameters: GatewayParameters) -> None:
        self.s = Gateway(waits=float(parameters.auto_enable))
        self.change(parameters)
        self.devices: dict[str, Device] = {
            "Drive11": self.s.drive_11, "Drive12": self.s.drive_12, "Load11": self.s.load_11, "Load12": self.s.load_12
        }  # fmt: skip
        f = self._frames = bench_frames(database)
        self._own = {"Drive11": f.drive_11, "Drive12": f.drive_12, "Load11": f.load_11, "Load12": f.load_12}
        self._heard: dict[int, tuple[str, int, int]] = {
            int(identifier): (name, kind, int(getattr(f, SENT[kind].lower()).length))
            for name, own in self._own.items()
            for kind, identifier in enumerate(own.identifiers)
        }

    def change(self, parameters: GatewayParameters) -> None:
        """Go on with other limits and time-outs."""
        self.p: Any = namespace(number_tree(parameters))

    def receive(self, circuit: str, frame: Frame) -> None:
        """Take a frame from the channel of a circuit, if it is of one of its devices."""
        name, kind, length = self._heard.get(frame.identifier, ("", 0, 0))
        if not name or not name.endswith(circuit):
            return
        feedback = self.devices[name].feedback
        if len(frame.data) != length:
            feedback.refused += 1.0
            return
        receive_feedback(self._frames, self._own[name], feedback, kind, int.from_bytes(frame.data, "little"))

    def command(self, name: str, mode: int, value: float) -> None:
        """What a device shall do: a torque [N m] or a speed [rad/s] at its shaft; ValueError for what is no number."""
        if not isfinite(value):
            raise ValueError(f"command of {name}: {value} is refused, allowed is a finite number")
        command_device(self.p, self.devices[name], mode, value)

    def enable(self, names: tuple[str, ...]) -> str:
        """Begin to enable devices, or say in one line why none of them is."""
        reasons = {
            LATCHED: "has a latched fault: reset it first",
            SILENT: f"says nothing: no valid feedback within {self.p.feedback_timeout:g} s",
            DOUBTFUL: "measures what cannot be",
            WITHOUT_COMMAND: f"has no command: none came within {self.p.command_timeout:g} s",
        }
        for name in names:
            found = refusal(self.p, self.devices[name])
            if found != MAY_BE_ENABLED:
                return f"{name} {reasons[found]}"
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
        before = self.s.tick
        advance_gateway(self.p, self.s, float(ticks), ticks * TICK)
        frames = [(name[-2:], self._set_point(name, self._own[name])) for name in DEVICES]
        if is_due(self._frames.heartbeat.ticks, before, self.s.tick):
            frames += [(circuit, self._life_sign(place)) for place, circuit in enumerate(CIRCUITS)]
        return frames

    def _set_point(self, name: str, own: DeviceFrames) -> Frame:
        most = self.p.torque_limit if name in DRIVES else self.p.load_torque_limit
        payload = set_point(self._frames, own, self.devices[name], most)
        return Frame(int(own.set_point), payload.to_bytes(int(self._frames.set_point.length), "little"))

    def _life_sign(self, place: int) -> Frame:
        payload = heartbeat(self._frames, self.s, place)
        return Frame(int(self._frames.ecu), payload.to_bytes(int(self._frames.heartbeat.length), "little"))
