"""The bench as a role of the graph in real time: its inverters on a CAN bus, in cycles of 1 ms.

How it works: frames come by `receive` and time by `cycle`; the circuits are those of lockstep. An
instant of the graph ends a period (`_take`): means, heat and counts of the bus become the outputs,
and begin anew.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from typing import Any

from ev_bench.bus.channel import BusMeter
from ev_bench.bus.parameters import CIRCUITS, load_database
from ev_bench.inverter.circuit_station import ChannelStation, InverterStation
from ev_bench.inverter.on_channel import MOTION
from ev_bench.machines.bus_faults import BusFault, on_the_way, present, put_in
from ev_bench.machines.can_circuit import (
    FEEDBACK_WORDS,
    SET_POINT_WORDS,
    CanConstants,
    Line,
    make_cycle,
)
from ev_bench.machines.circuit import begin_period, end_period
from ev_bench.machines.described import CircuitState
from ev_core.law import BatteryCondition
from ev_core.lockstep.configuration import Configuration
from ev_core.methods.law import LawObject
from ev_msgs_py.can.frame_length import Frame
from ev_msgs_py.can.frames import TICK, bench_frames
from ev_msgs_py.can.payload import NO_FRAME, joined, words
from ev_msgs_py.contract.optional_signals import MOST_TICKS, SetPointFrames

_MEANS = ("mean_torque", "mean_load_torque", "mean_shaft_torque", "power", "load_power")


def meters_of(database: str) -> dict[str, BusMeter]:
    """Meters of both channels for the inverters, which await the set-points."""
    frames = bench_frames(load_database(database))
    devices = ((frames.drive_11, frames.load_11), (frames.drive_12, frames.load_12))
    return {
        c: BusMeter([int(d.set_point) for d in own])
        for c, own in zip(CIRCUITS, devices, strict=True)
    }


class BenchStation(ChannelStation):
    """One circuit of the bench on its channel, with the faults that are put into it."""

    def __init__(
        self, p: Any, c: CanConstants, number: int, s: CircuitState, line: Line, meter: BusMeter
    ) -> None:  # fmt: skip
        self.s, self.line, self.meter = s, line, meter
        self._p, self._c, self._number = p, c, number
        frames = c.frames
        own = ((frames.drive_11, frames.load_11), (frames.drive_12, frames.load_12))[number]
        self.inverters = (
            InverterStation(frames, own[0], s.machine),
            InverterStation(frames, own[1], s.load),
        )
        self.inverters[0].p, self.inverters[1].p = c.circuits.machine, p.load
        self._drive = own[0].set_point
        self._places = {
            int(identifier): (device, kind)
            for device, frames_of in enumerate(own)
            for kind, identifier in enumerate(frames_of.identifiers)
        }
        self._motions = tuple(deque[int](maxlen=MOST_TICKS) for _ in own)
        self._tick = 0.0
        self._made = 0  # cycles since the last instant; those that were lost show nothing
        self._has_begun = False

    def receive(self, frame: Frame) -> None:
        """Take a frame of the channel; on the way to the drive a fault may be."""
        # The faults of the bus are those of the drive's set-points. One of a wrong length counts as
        # damaged there, as without a fault.
        if frame.identifier != self._drive or len(frame.data) != self._c.frames.set_point.length:
            super().receive(frame)
            return
        kind = self._fault(self._tick)
        arrived = on_the_way(
            self._p.inject, self.line.fault, kind, *words(int.from_bytes(frame.data, "little"))
        )
        if arrived.low != NO_FRAME:
            self.inverters[0].hear(joined(arrived.low, arrived.high))

    def advance(self, tick: float) -> tuple[float, float]:
        """Both inverters, their machines and the shaft."""
        self._made += 1
        kind = self._fault(tick)
        put_in(self._p.inject, self.s.machine.injected, kind)
        make_cycle(self._p, self._c, self._number, self.s, tick, kind == BusFault.LOAD_LIMIT)
        return self.s.speed, self.s.load_speed

    def _fault(self, tick: float) -> int:
        """The kind that is there in a tick; none before the first instant."""
        return (
            present(self._p.inject, tick, self._number) if self._has_begun else int(BusFault.NONE)
        )

    def cycle(self, before: float, ticks: int) -> list[Frame]:
        """Advance by some cycles; what is to be sent, which is kept for `end_period`, too."""
        frames = self.make_cycles(before, ticks)
        self._tick = before + ticks
        for frame in frames:
            device, kind = self._places[frame.identifier]
            payload = int.from_bytes(frame.data, "little")
            if kind == MOTION:
                self._motions[device].append(payload)
            else:
                place = FEEDBACK_WORDS * device + SET_POINT_WORDS + 2 * (kind - 1)
                self.line.feedback[place : place + 2] = words(payload)
        return frames

    def end_period(self, ticks: float, bit_rate: float) -> None:
        """End a control period of some ticks: means, heat, and counts of the bus."""
        # The sums count each cycle as one of the `c.ticks` of a period; there may have been more or
        # fewer.
        mean = self._c.ticks / self._made
        for name in _MEANS:
            setattr(self.s, name, mean * getattr(self.s, name))
        end_period(self._p, self._c.circuits, self.s, ticks * TICK)
        for device, motions in enumerate(self._motions):
            for tick, payload in enumerate(motions):
                place = FEEDBACK_WORDS * device + 2 * tick
                self.line.feedback[place : place + 2] = words(payload)
        channel = self.line.channel
        # In the units of the model of the bus: bits of one control period.
        channel.busy = self._c.ticks / ticks * self.meter.bits
        channel.latency = self.meter.latency * bit_rate
        channel.lost = sum(inverter.lost for inverter in self.inverters)

    def go_on_from(self, other: BenchStation) -> None:
        """Take over what another one keeps of the period, besides its state."""
        self._tick = other._tick
        self._made = other._made
        self._motions = other._motions
        self._has_begun = other._has_begun
        for inverter, before in zip(self.inverters, other.inverters, strict=True):
            inverter.lost = before.lost

    def begin(self) -> None:
        """Count ticks from here on, the first instant, as those of faults do."""
        self._has_begun = True
        self._tick = 0.0

    def begin_period(self) -> None:
        """Restart means and counts."""
        begin_period(self.s)
        self._made = 0
        self.meter.clear()
        self.line.feedback[:] = [NO_FRAME] * len(self.line.feedback)
        for motions in self._motions:
            motions.clear()


class BenchOnBus(LawObject):
    """Player of the role by the method `circuits_on_can`, with frames on a bus.

    Its signals are means over, and frames since, the instant before; an instant without a cycle
    repeats the one before.
    """

    def __init__(self, configuration: Configuration, meters: Mapping[str, BusMeter]) -> None:
        common, law = configuration.common, configuration.method.law
        assert law is not None, "the method `circuits_on_can` is made of functions"
        super().__init__(law, configuration.parameters, common.vehicle, common.control_period)
        p, c, s = (self.given[name] for name in "pcs")
        places = ((s.circuits[int(c.right)], s.line_11), (s.circuits[int(c.left)], s.line_12))
        self._circuits = {
            circuit: BenchStation(p, c, number, *places[number], meters[circuit])
            for number, circuit in enumerate(CIRCUITS)
        }
        self._tick = self._last_tick = 0.0  # cycles so far, and those until the last instant
        self._has_begun = False
        self._last_outputs = super().outputs()
        self.advance = self._take

    def receive(self, circuit: str, frame: Frame) -> None:
        """Set-points, or frames for others."""
        self._circuits[circuit].receive(frame)

    def cycle(self, ticks: int) -> list[tuple[str, Frame]]:
        """Advance everything; the frames that the inverters send."""
        before = self._tick
        self._tick += ticks
        return [
            (name, frame)
            for name, one in self._circuits.items()
            for frame in one.cycle(before, ticks)
        ]

    def _take(self, _set_points: SetPointFrames, battery: BatteryCondition) -> None:
        """Take an instant: what has happened since the last one.

        The first one starts time for faults.
        """
        s, c, ticks = self.given["s"], self.given["c"], self._tick - self._last_tick
        s.voltage = battery.voltage
        # Two instants may come within one cycle: nothing has happened, and the outputs stay.
        if ticks == 0.0:
            return
        for circuit in self._circuits.values():
            circuit.end_period(ticks, self.given["p"].bus.bit_rate)
        if not self._has_begun:
            self._begin()
        s.periods, self._last_tick = self._tick / c.ticks, self._tick
        self._last_outputs = super().outputs()
        for circuit in self._circuits.values():
            circuit.begin_period()

    def go_on_from(self, other: BenchOnBus) -> None:
        """Take over sums of another bench with the same state, so that means cover all cycles."""
        self._tick, self._last_tick = other._tick, other._last_tick
        self._has_begun, self._last_outputs = other._has_begun, other._last_outputs
        for name, circuit in self._circuits.items():
            circuit.go_on_from(other._circuits[name])

    def _begin(self) -> None:
        """Let time begin for faults, here and in the stations, which judge what comes meanwhile."""
        self._has_begun = True
        self._tick = 0.0
        for circuit in self._circuits.values():
            circuit.begin()

    def outputs(self) -> tuple[Any, ...]:
        """Outputs of the last instant."""
        return self._last_outputs
