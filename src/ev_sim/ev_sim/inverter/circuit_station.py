"""One circuit on its channel: frames in, cycles, frames out. No bus, no clock: time is counted from outside."""

from __future__ import annotations

from typing import Any

from ev_core.bus.channel import Frame
from ev_core.bus.checking import is_valid
from ev_core.law import compilable
from ev_core.methods.law import namespace
from ev_core.parameters.declaration import number_tree
from ev_msgs_py.can.database import Database
from ev_msgs_py.can.frames import SENT, TICK, BenchFrames, DeviceFrames, bench_frames, is_due
from ev_sim.inverter.device import Circuit, Inverter
from ev_sim.inverter.inverter import advance_inverter
from ev_sim.inverter.inverter_parameters import CircuitParameters
from ev_sim.inverter.on_channel import grow_older, made, receive_set_point, ticks_between


@compilable
def advance_circuit(p: CircuitParameters, s: Circuit, period: float) -> None:
    """Advance both inverters, then the shaft, which is rigid: (J_drive + J_load) w' = T_drive + T_load - b w."""
    advance_inverter(p.drive, s.drive, s.speed, period)
    advance_inverter(p.load, s.load, s.speed, period)
    inertia = p.drive.machine.rotor_inertia + p.load.machine.rotor_inertia
    s.speed = (s.speed + period * (s.drive.torque + s.load.torque) / inertia) / (1.0 + period * p.friction / inertia)


_MADE_GOOD = 5  # cycles that are made up for at once
_DAMAGED = 0xFF  # a payload whose checksum is wrong


class InverterStation:
    """One inverter: it takes its set-points and sends its frames."""

    p: Any  # the numbers of its parameters

    def __init__(self, frames: BenchFrames, own: DeviceFrames, s: Inverter) -> None:
        self.s = s
        self._frames, self._own = frames, own
        self.lost = 0.0  # set-points, by their counters
        self._lengths = [int(getattr(frames, kind.lower()).length) for kind in SENT]

    def receive(self, frame: Frame) -> None:
        """Take a frame if it is a set-point of this inverter; one with another length counts as damaged."""
        if frame.identifier != self._own.set_point:
            return
        length = self._frames.set_point.length
        self.hear(int.from_bytes(frame.data, "little") if len(frame.data) == length else _DAMAGED)

    def hear(self, payload: int) -> None:
        """Take a set-point, and count those that were lost before it."""
        if is_valid(receive_set_point(self._frames.set_point, self._own, self.s, payload)):
            self.lost += self.s.check.lost_data

    def due(self, before: float, now: float, speed: float) -> list[Frame]:
        """The frames whose cycle ends between two ticks."""
        return [
            Frame(
                int(self._own.identifiers[kind]),
                made(self._frames, self._own, self.p, self.s, kind, speed).to_bytes(length, "little"),
            )
            for kind, length in enumerate(self._lengths)
            if self.s.injected.silent == 0.0 and is_due(ticks_between(self._frames, kind), before, now)
        ]


class ChannelStation:
    """The two inverters of a channel, behind a shaft that a subclass turns."""

    inverters: tuple[InverterStation, InverterStation]

    def receive(self, frame: Frame) -> None:
        """Take a frame of the channel."""
        for inverter in self.inverters:
            inverter.receive(frame)

    def advance(self, tick: float) -> tuple[float, float]:
        """Make the cycle of a tick; the speeds of both machines [rad/s]."""
        raise NotImplementedError

    def make_cycles(self, before: float, ticks: int) -> list[Frame]:
        """Advance by some cycles of 1 ms, after the frames of this cycle; what is to be sent then.

        After more than a few the machines stand still for the rest, as a burst of late cycles would be no real time;
        the set-points get older all the same.
        """
        lost, speeds = max(ticks - _MADE_GOOD, 0), (0.0, 0.0)
        for inverter in self.inverters:
            grow_older(inverter.s, lost * TICK)
        for tick in range(lost, ticks):
            speeds = self.advance(before + tick)
        both = zip(self.inverters, speeds, strict=True)
        return [frame for inverter, speed in both for frame in inverter.due(before, before + ticks, speed)]


class CircuitStation(ChannelStation):
    """The two inverters of a circuit on one channel, with their shaft, which is rigid."""

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

    def advance(self, tick: float) -> tuple[float, float]:
        """Both inverters and the shaft."""
        advance_circuit(self.p, self.s, TICK)
        return self.s.speed, self.s.speed

    def step(self, ticks: int = 1) -> list[Frame]:
        """Advance by some cycles of 1 ms, after the frames of this cycle; what is to be sent then."""
        before = self.s.tick
        self.s.tick += ticks
        return self.make_cycles(before, ticks)
