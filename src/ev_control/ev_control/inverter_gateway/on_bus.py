"""The gateway as a role of the graph in real time: orders at the instants, frames on the bus in cycles of 1 ms."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

from ev_control.inverter_gateway.can import ALL_SAID, HEARTBEATS, LOADS, SAID, note_faults
from ev_control.inverter_gateway.orders import command_drives, command_loads, press_buttons, watch_bench
from ev_control.inverter_gateway.station import GatewayStation
from ev_core.bus.channel import Frame
from ev_core.bus.database_file import load_database
from ev_core.bus.parameters import CIRCUITS
from ev_core.lockstep.configuration import Configuration
from ev_core.methods.law import LawObject
from ev_msgs_py.can.payload import NO_FRAME, words
from ev_msgs_py.contract.bus_signals import MOST_TICKS, FeedbackFrames, SetPointFrames
from ev_msgs_py.contract.optional_signals import BenchShafts, LoadCommand
from ev_msgs_py.contract.signals import WheelTorqueCommand

_DEVICES = ("drive_11", "drive_12", "load_11", "load_12")
_PLACES = (0, SAID, LOADS, LOADS + SAID)  # of their set-points in SetPointFrames


class GatewayOnBus(LawObject):
    """Plays the role by the method `can`, with a `station` that speaks on the bus in the place of frames as signals.

    Its signals are what it has said since the instant before, the newest frames if there were too many. `newest` tells
    the stamp of the newest torque command.
    """

    def __init__(self, configuration: Configuration, newest: Callable[[], int]) -> None:
        common, p = configuration.common, configuration.parameters
        law = configuration.method.law
        assert law is not None, "the method `can` is made of functions"
        super().__init__(law, p, common.vehicle, common.control_period)
        self._period = common.control_period
        self.station = GatewayStation(load_database(p.bus.database), p)
        self.given["s"].gateway = self.station.s
        frames = self.given["c"].frames
        self._places = {
            int(getattr(frames, name).set_point): place for name, place in zip(_DEVICES, _PLACES, strict=True)
        }
        self._set_points: dict[int, deque[int]] = {place: deque(maxlen=MOST_TICKS) for place in _PLACES}
        self._heartbeats: dict[int, int] = {}
        self._heard_before = [(0.0, 0.0), (0.0, 0.0)]
        self._has_begun = False
        self._newest = newest
        self.step = self._answer

    def receive(self, circuit: str, frame: Frame) -> None:
        """Feedback, or frames for others."""
        self.station.receive(circuit, frame)

    def cycle(self, ticks: int) -> list[tuple[str, Frame]]:
        """Press the buttons that are due, lead the inverters on; what is to be sent."""
        c, g = self.given["c"], self.station.s
        now = g.tick
        for tick in range(ticks):
            g.tick = now + tick
            press_buttons(c.enable_tick, c.reset_tick, g)
        g.tick = now
        frames = self.station.step(ticks)
        for circuit, frame in frames:
            payload, place = int.from_bytes(frame.data, "little"), self._places.get(frame.identifier)
            if place is None:
                self._heartbeats[CIRCUITS.index(circuit)] = payload
            else:
                self._set_points[place].append(payload)
        return frames

    def _answer(
        self, command: WheelTorqueCommand, load: LoadCommand, _heard: FeedbackFrames, shafts: BenchShafts
    ) -> SetPointFrames:
        """Take the orders of an instant; with the first one time begins for the buttons."""
        if not self._has_begun:
            self._has_begun, self.station.s.tick = True, 0.0
        p, g = self.given["p"], self.station.s
        newest = float(self._newest())
        if newest > g.commanded:  # else it is held from before, and gets too old (`command_timeout`)
            command_drives(p, g, command)
        g.commanded = newest
        command_loads(p, g, load)
        # The bench says at an instant what it measured before the last one (`BenchOnBus`).
        for place, device in enumerate((g.drive_11, g.drive_12)):
            of = device.feedback
            now, (of.torque_sum, of.torque_count) = (of.torque_sum, of.torque_count), self._heard_before[place]
            self._heard_before[place] = now
        watch_bench(p, self.given["car"].motor.rotor_inertia, g, load, shafts, self._period)
        note_faults(self.given["s"])
        return SetPointFrames(*self._said())

    def _said(self) -> list[float]:
        said = [NO_FRAME] * ALL_SAID
        for begin, payloads in self._set_points.items():
            for tick, payload in enumerate(payloads):
                said[begin + 2 * tick : begin + 2 * tick + 2] = words(payload)
            payloads.clear()
        for place, payload in self._heartbeats.items():
            said[HEARTBEATS + place] = words(payload)[0]
        self._heartbeats.clear()
        return said

    def goes_on(self) -> None:
        """Time has begun."""
        self._has_begun = True
