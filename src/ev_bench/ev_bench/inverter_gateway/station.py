"""Gateway without ROS and clock: frames and commands in, one cycle, frames out.

`GatewayOnBus` plays the role of the graph in real time: orders come at the instants, frames go over
the bus in cycles of 1 ms.
"""

from collections import deque
from collections.abc import Callable
from math import isfinite
from typing import Any

from ev_bench.bus.parameters import CIRCUITS, load_database
from ev_bench.inverter_gateway import can, leading
from ev_bench.inverter_gateway.gateway import Device, Gateway, GatewayParameters, check_limits
from ev_core.lockstep.configuration import Configuration
from ev_core.methods.law import LawObject, namespace
from ev_core.parameters.declaration import number_tree
from ev_msgs_py.can.database import Database
from ev_msgs_py.can.frame_length import Frame
from ev_msgs_py.can.frames import DEVICES, DRIVES, SENT, TICK, DeviceFrames, bench_frames, is_due
from ev_msgs_py.can.payload import NO_FRAME, words
from ev_msgs_py.contract.optional_signals import (
    MOST_TICKS,
    BenchShafts,
    FeedbackFrames,
    LoadCommand,
    SetPointFrames,
)
from ev_msgs_py.contract.signals import WheelTorqueCommand

# Places of the devices' set-points in SetPointFrames.
_PLACES = (0, can.SET_POINTS, can.LOADS, can.LOADS + can.SET_POINTS)


class GatewayStation:
    """Gateway of four inverters on two channels; `devices` are their states, `own` their frames."""

    def __init__(self, database: Database, parameters: GatewayParameters) -> None:
        self.s = Gateway(waits=float(parameters.auto_enable))
        self._frames = bench_frames(database)
        self.change(parameters)
        self.devices: dict[str, Device] = {
            "Drive11": self.s.drive_11,
            "Drive12": self.s.drive_12,
            "Load11": self.s.load_11,
            "Load12": self.s.load_12,
        }
        f = self._frames
        self.own = {
            "Drive11": f.drive_11,
            "Drive12": f.drive_12,
            "Load11": f.load_11,
            "Load12": f.load_12,
        }
        # By identifier: device, kind and length of a frame of feedback.
        self._feedback: dict[int, tuple[str, int, int]] = {}
        for name, own in self.own.items():
            for kind, identifier in enumerate(own.identifiers):
                length = int(getattr(f, SENT[kind].lower()).length)
                self._feedback[int(identifier)] = (name, kind, length)

    def change(self, parameters: GatewayParameters) -> None:
        """Go on with other limits and time-outs; refuse a limit that the frames do not have."""
        check_limits(self._frames.set_point, parameters)
        self.p: Any = namespace(number_tree(parameters))

    def receive(self, circuit: str, frame: Frame) -> None:
        """Take a frame from the channel of a circuit, if it is of one of its devices."""
        name, kind, length = self._feedback.get(frame.identifier, ("", 0, 0))
        # The same identifier on the other channel is not from this device.
        if not name or not name.endswith(circuit):
            return
        feedback = self.devices[name].feedback
        # A checksum is over a fixed length: a frame of another one cannot be right.
        if len(frame.data) != length:
            feedback.refused += 1.0
            return
        leading.receive_feedback(
            self._frames, self.own[name], feedback, kind, int.from_bytes(frame.data, "little")
        )

    def command(self, name: str, mode: int, value: float) -> None:
        """Command a device: a torque [N m] or a speed [rad/s] at its shaft.

        Raises ValueError for what is no number.
        """
        if not isfinite(value):
            raise ValueError(f"command of {name}: {value} is refused, expected a finite number")
        leading.command_device(self.devices[name], mode, value)

    def enable(self, names: tuple[str, ...]) -> str:
        """Begin to enable devices, or return the reason, in one line, why none of them is."""
        reasons = {
            leading.LATCHED: "has a latched fault: reset it first",
            leading.SILENT: f"is silent: no valid feedback within {self.p.feedback_timeout:g} s",
            leading.DOUBTFUL: "measures what cannot be",
            leading.WITHOUT_COMMAND: f"has no command: none within {self.p.command_timeout:g} s",
        }
        # All of them or none: nothing is enabled before all have been looked at.
        for name in names:
            found = leading.refusal(self.p, self.devices[name])
            if found != leading.MAY_BE_ENABLED:
                return f"{name} {reasons[found]}"
        for name in names:
            self.devices[name].enable = True
        return ""

    def disable(self) -> None:
        """Take torque and voltage from everything; nothing is enabled by itself any more."""
        self.s.waits = 0.0
        for device in self.devices.values():
            device.enable = False

    def reset(self) -> None:
        """Begin the reset sequence of everything; nothing is enabled after it, nor by itself."""
        self.s.waits = 0.0
        for device in self.devices.values():
            leading.begin_reset(device)

    def step(self, ticks: int = 1) -> list[tuple[str, Frame]]:
        """Advance by some cycles of 1 ms; return the frames to send, each with its circuit."""
        before = self.s.tick
        leading.advance_gateway(self.p, self.s, float(ticks), ticks * TICK)
        frames = [(name[-2:], self._set_point(name, self.own[name])) for name in DEVICES]
        if is_due(self._frames.heartbeat.ticks, before, self.s.tick):
            for place, circuit in enumerate(CIRCUITS):
                frames.append((circuit, self._life_sign(place)))
        return frames

    def _set_point(self, name: str, own: DeviceFrames) -> Frame:
        most = self.p.torque_limit if name in DRIVES else self.p.load_torque_limit
        limits = leading.Limits(most, self.p.speed_limit)
        payload = leading.set_point(self._frames, own, self.devices[name], limits)
        return Frame(
            int(own.set_point), payload.to_bytes(int(self._frames.set_point.length), "little")
        )

    def _life_sign(self, place: int) -> Frame:
        payload = leading.heartbeat(self._frames, self.s, place)
        return Frame(
            int(self._frames.ecu), payload.to_bytes(int(self._frames.heartbeat.length), "little")
        )


class GatewayOnBus(LawObject):
    """Player of the role by the method `can`, with a `station` on the bus in place of frames.

    Its signals are the frames that it has sent since the instant before, the newest ones if there
    are too many. `newest` gives the stamp of the newest torque command.
    """

    def __init__(self, configuration: Configuration, newest: Callable[[], int]) -> None:
        common, p = configuration.common, configuration.parameters
        law = configuration.method.law
        assert law is not None, "the method `can` is made of functions"
        super().__init__(law, p, common.vehicle, common.control_period)
        self._period = common.control_period
        self.station = GatewayStation(load_database(p.bus.database), p)
        self.given["s"].gateway = self.station.s
        devices = self.station.own.values()
        self._places = {
            int(own.set_point): place for own, place in zip(devices, _PLACES, strict=True)
        }
        self._set_points: dict[int, deque[int]] = {
            place: deque(maxlen=MOST_TICKS) for place in _PLACES
        }
        self._heartbeats: dict[int, int] = {}
        self._torques_before = [(0.0, 0.0), (0.0, 0.0)]
        self._has_begun = False
        self._newest = newest
        self.step = self._answer

    def receive(self, circuit: str, frame: Frame) -> None:
        """Take feedback; frames for other devices are left alone."""
        self.station.receive(circuit, frame)

    def cycle(self, ticks: int) -> list[tuple[str, Frame]]:
        """Press the buttons that are due, lead the inverters on; return the frames to send."""
        c, g = self.given["c"], self.station.s
        now = g.tick
        # A button belongs to one tick, so none of those that were held up is left out.
        for tick in range(ticks if self._has_begun else 0):
            g.tick = now + tick
            can.press_buttons(c.enable_tick, c.reset_tick, g)
        g.tick = now
        frames = self.station.step(ticks)
        for circuit, frame in frames:
            payload = int.from_bytes(frame.data, "little")
            place = self._places.get(frame.identifier)
            if place is None:
                self._heartbeats[CIRCUITS.index(circuit)] = payload
            else:
                self._set_points[place].append(payload)
        return frames

    def _answer(
        self,
        command: WheelTorqueCommand,
        load: LoadCommand,
        _feedback: FeedbackFrames,
        shafts: BenchShafts,
    ) -> SetPointFrames:
        """Take the orders of an instant; with the first one time begins for the buttons."""
        if not self._has_begun:
            self._has_begun = True
            self.station.s.tick = 0.0
        p, g = self.given["p"], self.station.s
        newest = float(self._newest())
        if (
            newest > g.commanded
        ):  # else it is held from before, and gets too old (`command_timeout`)
            can.command_drives(p, g, command)
        g.commanded = newest
        can.command_loads(p, g, load)
        # The output of the bench at an instant is what it measured before the last one
        # (`BenchOnBus`).
        for place, device in enumerate((g.drive_11, g.drive_12)):
            of = device.feedback
            now = (of.torque_sum, of.torque_count)
            # So the feedback of the same period is compared with it.
            of.torque_sum, of.torque_count = self._torques_before[place]
            self._torques_before[place] = now
        can.watch_bench(p, self.given["car"].motor.rotor_inertia, g, load, shafts, self._period)
        can.note_faults(self.given["s"])
        return SetPointFrames(*self._sent())

    def _sent(self) -> list[float]:
        sent = [NO_FRAME] * can.ALL_SET_POINTS
        for begin, payloads in self._set_points.items():
            for tick, payload in enumerate(payloads):
                sent[begin + 2 * tick : begin + 2 * tick + 2] = words(payload)
            payloads.clear()
        for place, payload in self._heartbeats.items():
            sent[can.HEARTBEATS + place] = words(payload)[0]
        self._heartbeats.clear()
        return sent

    def go_on_from(self, other: "GatewayOnBus") -> None:
        """Take over what a gateway with the same state keeps between two instants."""
        self._has_begun, self._torques_before = other._has_begun, other._torques_before
        self._set_points, self._heartbeats = other._set_points, other._heartbeats
