"""The cycles of an inverter, and one circuit on its channel.

How it works: in each cycle of an inverter causes of faults are latched, the state machine of CiA
402 takes a step, torque and temperatures follow, and frames are made of the result. `lead_inverter`
is the part before the torque and `end_inverter_cycle` the part behind it, so that a bench can turn
a shaft of its own in between.

Neither bus nor clock is used here: the caller counts time.
"""

from __future__ import annotations

from typing import Any

from ev_bench.bus import checking
from ev_bench.inverter import on_channel, power_stage
from ev_bench.inverter.device import Circuit, CircuitParameters, Inverter, InverterParameters
from ev_core.law import compilable
from ev_core.methods.law import namespace
from ev_core.parameters.declaration import number_tree
from ev_msgs_py.can import drive_states, frames
from ev_msgs_py.can.database import Database
from ev_msgs_py.can.frame_length import Frame
from ev_msgs_py.can.frames import SENT, TICK, BenchFrames, DeviceFrames, bench_frames, is_due

_NO_TORQUE = 1.0  # N m, the error of the torque transducer: below it a quick stop is over
_CODES = tuple(float(fault.code) for fault in frames.FAULTS)
_MADE_GOOD = 5  # cycles that are made up for at once
_DAMAGED = 0xFF  # a payload with a wrong checksum


@compilable
def advance_inverter(p: InverterParameters, s: Inverter, speed: float, period: float) -> None:
    """Advance by `period` [s] at a shaft speed [rad/s], after the frames of this cycle.

    A fault takes the torque away in the cycle in which it is found.
    """
    lead_inverter(p, s, speed, period)
    power_stage.advance_torque(p, s, speed, period)
    power_stage.advance_temperatures(p.thermal, p.machine, s, period)
    end_inverter_cycle(p, s, period)


@compilable
def lead_inverter(p: InverterParameters, s: Inverter, speed: float, period: float) -> None:
    """The first part of a cycle: what is wrong, and which state follows."""
    if s.supervision.heard == 0.0:
        checking.no_new_data(s.check)
    s.supervision.heard = 0.0
    power_stage.advance_dc_link(p.dc_link, s, period)
    causes = _causes(p, s, speed, period)
    _latch(s, causes)
    control, torque_gone = int(s.command.controlword), abs(s.torque) < _NO_TORQUE
    silent = on_channel.missing_set_point(s, p.command_timeout, period) != 0
    before, charged = int(s.state), s.dc_link.contactor != 0.0
    # In a fault missing set-points are no cause (`_causes`), so a reset asks for them itself.
    reset, faulty = s.command.reset != 0.0 and not silent, causes != 0
    s.state = float(drive_states.next_state(before, control, reset, faulty, charged, torque_gone))
    if s.state == drive_states.SWITCH_ON_DISABLED and not faulty:
        s.faults = s.error_code = 0.0
    # The direction is taken over before operation; to change it within is a fault (`_causes`).
    if s.state != drive_states.OPERATION_ENABLED:
        s.direction = s.command.direction


@compilable
def end_inverter_cycle(p: InverterParameters, s: Inverter, period: float) -> None:
    """End a cycle, after torque and temperatures: warnings, and ages of all frames."""
    s.warnings = float(_warnings(p, s))
    on_channel.grow_older(s, period)
    s.command.reset = 0.0


@compilable
def _causes(p: InverterParameters, s: Inverter, speed: float, period: float) -> int:
    """The bits of everything that is wrong now."""
    state, mode = int(s.state), int(s.command.mode)
    bits = power_stage.dc_link_faults(p.dc_link, s)
    if power_stage.winding_temperature(p.thermal, s) > p.thermal.winding_limit:
        bits |= frames.WINDING_TEMPERATURE
    if power_stage.inverter_temperature(p.thermal, s) > p.thermal.inverter_limit:
        bits |= frames.INVERTER_TEMPERATURE
    if s.injected.trip != 0.0:
        bits |= frames.TRIP
    if abs(speed) > p.over_speed * p.machine.maximum_speed:
        bits |= frames.OVER_SPEED
    if s.phase_current + s.injected.current_rise > p.largest_current:
        bits |= frames.OVER_CURRENT
    # A device that is not being switched on needs no set-points.
    if drive_states.READY_TO_SWITCH_ON <= state <= drive_states.QUICK_STOP_ACTIVE:
        bits |= on_channel.missing_set_point(s, p.command_timeout, period)
        offered = mode in (frames.NO_MODE, frames.TORQUE_MODE) or (
            mode == frames.SPEED_MODE and p.offers_speed_mode != 0.0
        )
        if not offered:
            bits |= frames.MODE_REFUSED
    if state == drive_states.OPERATION_ENABLED and s.command.direction != s.direction:
        bits |= frames.DIRECTION_CHANGED
    return bits


@compilable
def _latch(s: Inverter, causes: int) -> None:
    # The error code names what came first; of several at once the lowest bit.
    if causes != 0 and s.faults == 0.0:
        place = 0
        while (causes >> place) & 1 == 0:
            place += 1
        s.error_code = _CODES[place]
    s.faults = float(int(s.faults) | causes)


@compilable
def _warnings(p: InverterParameters, s: Inverter) -> int:
    bits = 0
    if power_stage.derating(p.thermal, s) < 1.0:
        bits |= frames.DERATING | frames.WARM
    if s.supervision.refused_age <= p.command_timeout:
        bits |= frames.FRAME_REFUSED
    if s.supervision.lost_age <= p.command_timeout:
        bits |= frames.FRAMES_LOST
    if s.dc_link.contactor != 0.0 and s.dc_link.voltage < 0.9 * p.dc_link.supply_voltage:
        bits |= frames.DC_LINK_LOW
    return bits


@compilable
def advance_circuit(p: CircuitParameters, s: Circuit, period: float) -> None:
    """Advance both inverters, then the shaft: (J_drive + J_load) w' = T_drive + T_load - b w."""
    advance_inverter(p.drive, s.drive, s.speed, period)
    advance_inverter(p.load, s.load, s.speed, period)
    inertia = p.drive.machine.rotor_inertia + p.load.machine.rotor_inertia
    # Friction is taken implicitly, which is stable for any of it.
    s.speed = (s.speed + period * (s.drive.torque + s.load.torque) / inertia) / (
        1.0 + period * p.friction / inertia
    )


class InverterStation:
    """One inverter: it takes its set-points and sends its frames."""

    p: Any  # the numbers of its parameters

    def __init__(self, frames: BenchFrames, own: DeviceFrames, s: Inverter) -> None:
        self.s = s
        self._frames, self._own = frames, own
        self.lost = 0.0  # set-points, by their counters
        self._lengths = [int(getattr(frames, kind.lower()).length) for kind in SENT]

    def receive(self, frame: Frame) -> None:
        """Take a frame if it is a set-point of this inverter; a wrong length counts as damage."""
        if frame.identifier != self._own.set_point:
            return
        length = self._frames.set_point.length
        self.hear(int.from_bytes(frame.data, "little") if len(frame.data) == length else _DAMAGED)

    def hear(self, payload: int) -> None:
        """Take a set-point, and count those that were lost before it."""
        if checking.is_valid(
            on_channel.receive_set_point(self._frames.set_point, self._own, self.s, payload)
        ):
            self.lost += self.s.check.lost_data

    def due(self, before: float, now: float, speed: float) -> list[Frame]:
        """Frames with a cycle that ends between two ticks."""
        return [
            Frame(
                int(self._own.identifiers[kind]),
                on_channel.made(self._frames, self._own, self.p, self.s, kind, speed).to_bytes(
                    length, "little"
                ),
            )
            for kind, length in enumerate(self._lengths)
            if self.s.injected.silent == 0.0
            and is_due(on_channel.ticks_between(self._frames, kind), before, now)
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

        After more than a few the machines stand still for the rest, as a burst of late cycles would
        be no real time; the set-points get older all the same.
        """
        # The oldest cycles are the ones that are lost.
        lost, speeds = max(ticks - _MADE_GOOD, 0), (0.0, 0.0)
        for inverter in self.inverters:
            on_channel.grow_older(inverter.s, lost * TICK)
        for tick in range(lost, ticks):
            speeds = self.advance(before + tick)
        both = zip(self.inverters, speeds, strict=True)
        return [
            frame
            for inverter, speed in both
            for frame in inverter.due(before, before + ticks, speed)
        ]


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
        """Advance by some cycles of 1 ms after this cycle's frames; return frames to send."""
        before = self.s.tick
        self.s.tick += ticks
        return self.make_cycles(before, ticks)
