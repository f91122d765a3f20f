"""One circuit on its channel: frames in, one cycle, frames out. No bus, no clock: time is counted from outside."""

from __future__ import annotations

from typing import Any

from ev_msgs_py.can.channel import Frame
from ev_msgs_py.can.database import Database
from ev_msgs_py.can.frames import SENT, BenchFrames, DeviceFrames, bench_frames
from ev_msgs_py.can.schedule import TICK
from ev_msgs_py.lockstep.law import namespace
from ev_msgs_py.parameters.declaration import number_tree
from ev_sim.inverter.circuit import advance_circuit
from ev_sim.inverter.frames import is_sent, made
from ev_sim.inverter.parameters import CircuitParameters
from ev_sim.inverter.set_points import grow_older, receive_set_point
from ev_sim.inverter.state import Circuit, Inverter

_MADE_GOOD = 5  # cycles that are made up for at once
_DAMAGED = 0xFF  # a payload whose checksum is wrong


class InverterStation:
    """One inverter: takes its set-points and says what its frames say."""

    p: Any  # the numbers of its parameters

    def __init__(self, frames: BenchFrames, own: DeviceFrames, s: Inverter) -> None:
        self.s = s
        self._frames, self._own = frames, own
        self._lengths = [int(getattr(frames, kind.lower()).length) for kind in SENT]

    def receive(self, frame: Frame) -> None:
        """Take a frame if it is a set-point of this inverter; one with another length counts as damaged."""
        if frame.identifier != self._own.set_point:
            return
        layout = self._frames.set_point
        payload = int.from_bytes(frame.data, "little") if len(frame.data) == layout.length else _DAMAGED
        receive_set_point(layout, self._own, self.s, payload)

    def due(self, before: float, now: float, speed: float) -> list[Frame]:
        """The frames whose cycle ends between two ticks."""
        return [
            Frame(
                int(self._own.identifiers[kind]),
                made(self._frames, self._own, self.p, self.s, kind, speed).to_bytes(length, "little"),
            )
            for kind, length in enumerate(self._lengths)
            if is_sent(self._frames, self.s, kind, before, now)
        ]


class CircuitStation:
    """The two inverters of a circuit on one channel, with their shaft."""

    def __init__(self, database: Database, circuit: str, parameters: CircuitParameters) -> None:
        self.s = Circuit()
        frames = bench_frames(database)
        self.inverters = (
            InverterStation(frames, getattr(frames, f"drive_{circuit}"), self.s.drive),
            InverterStation(frames, getattr(frames, f"load_{circuit}"), self.s.load),
        )
        self.change(parameters)

    def change(self, parameters: CircuitParameters) -> None:
        """Go on with other parameters."""
        self.p = namespace(number_tree(parameters))
        self.inverters[0].p, self.inverters[1].p = self.p.drive, self.p.load

    def receive(self, frame: Frame) -> None:
        """Take a frame of the channel."""
        for inverter in self.inverters:
            inverter.receive(frame)

    def step(self, ticks: int = 1) -> list[Frame]:
        """Advance by some cycles of 1 ms, after the frames of this cycle; what is to be sent then.

        After more than a few the machines stand still for the rest, as a burst of late cycles would be no real time;
        the set-points get older all the same.
        """
        before, lost = self.s.tick, max(ticks - _MADE_GOOD, 0)
        for inverter in self.inverters:
            grow_older(inverter.s, lost * TICK)
        for _ in range(ticks - lost):
            advance_circuit(self.p, self.s, TICK)
        self.s.tick += ticks
        return [f for inverter in self.inverters for f in inverter.due(before, self.s.tick, self.s.speed)]
