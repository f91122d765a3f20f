"""The gateway as a role of the graph: the same steps as in `station`, a period at a time, with frames as signals."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from ev_control.inverter_gateway.diagnosis import latched, latched_names
from ev_control.inverter_gateway.hearing import ELECTRICAL, FAULTS, MOTION, TEMPERATURES, receive_feedback
from ev_control.inverter_gateway.leading import advance_gateway, begin_reset, command_device
from ev_control.inverter_gateway.parameters import GatewayParameters
from ev_control.inverter_gateway.plausibility import PlausibilityParameters, watch
from ev_control.inverter_gateway.sending import heartbeat, set_point
from ev_control.inverter_gateway.state import Device, Gateway
from ev_msgs_py.can.conventions import TORQUE_MODE
from ev_msgs_py.can.database import load_database
from ev_msgs_py.can.frames import NO_FRAME, BenchFrames, DeviceFrames, are_words, bench_frames, joined, words
from ev_msgs_py.can.schedule import TICK, is_due, ticks_of
from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.bench_signals import BenchShafts
from ev_msgs_py.contract.bus_signals import MOST_TICKS, FeedbackFrames, SetPointFrames
from ev_msgs_py.contract.record import part, series
from ev_msgs_py.contract.signals import WheelStates, WheelTorqueCommand
from ev_msgs_py.elementary import isfinite
from ev_msgs_py.lockstep.methods import method
from ev_msgs_py.parameters.declaration import group, parameter
from ev_msgs_py.vehicle.description import Vehicle
from ev_msgs_py.vehicle.layout import listed

_OF_DRIVE = 2 * MOST_TICKS  # words of its set-points
_HEARD_OF_DRIVE = _OF_DRIVE + 6  # words of its feedback
_SAID = 2 * _OF_DRIVE + 2


@dataclass(frozen=True, slots=True)
class LockstepGatewayParameters(GatewayParameters):
    """The same, and what somebody does at its buttons."""

    auto_enable: bool = parameter(
        True, about="enable the drives once by itself, as soon as feedback and commands are there", read_only=True
    )
    plausibility: PlausibilityParameters = group(PlausibilityParameters)
    enable_at: float = parameter(-1.0, unit="s", low=-1.0, high=1e5, about="somebody enables both drives; -1: nobody")
    reset_at: float = parameter(
        -1.0, unit="s", low=-1.0, high=1e5, about="somebody begins a reset, with enabling after it; -1: nobody"
    )


class GatewayConstants(NamedTuple):
    """What is computed once."""

    ticks: float  # of 1 ms in a control period
    enable_tick: float
    reset_tick: float
    frames: BenchFrames


@dataclass(slots=True)
class LockstepGateway:
    """The gateway, and the frames of this period."""

    gateway: Gateway = part(Gateway)
    said: list[float] = series(_SAID, NO_FRAME, unit="1", about="as in SetPointFrames")
    noted: list[float] = series(2, unit="1", about="faults of each drive since the start, as `diagnosis.latched`")


def prepare(parameters: LockstepGatewayParameters, _vehicle: Vehicle, period: float) -> GatewayConstants:
    """Ticks and frames; ParameterError for a control period that is no such number of ticks."""
    ticks = ticks_of(period, MOST_TICKS)
    frames = bench_frames(load_database(parameters.bus.database))
    return GatewayConstants(
        ticks, float(round(parameters.enable_at / TICK)), float(round(parameters.reset_at / TICK)), frames
    )


def at_start(p: LockstepGatewayParameters) -> LockstepGateway:
    """Nothing is heard or enabled yet."""
    s = LockstepGateway()
    s.gateway.waits = p.auto_enable
    return s


def circuits_fit(parameters: LockstepGatewayParameters, vehicle: Vehicle) -> str:
    """The circuits are those of the driven wheels, behind the car's gear."""
    if {parameters.wheel_11, parameters.wheel_12} != set(vehicle.driven_wheels):
        return f"{listed((parameters.wheel_11, parameters.wheel_12))} as the only driven wheels"
    if parameters.gear_ratio != vehicle.gear_ratio:
        return f"a gear_ratio of {parameters.gear_ratio:g}, as its own, and not {vehicle.gear_ratio:g}"
    return ""


def notes(s: LockstepGateway) -> tuple[str, ...]:
    """The faults that were latched since the start."""
    drives = zip(("right drive", "left drive"), s.noted, strict=True)
    return tuple(f"{name}: {fault}" for name, bits in drives for fault in latched_names(int(bits)))


@method(
    "inverter_gateway",
    "can",
    LockstepGatewayParameters,
    state=LockstepGateway,
    prepare=prepare,
    start=at_start,
    notes=notes,
    needs=(circuits_fit,),
)
@compilable
def can(
    p: LockstepGatewayParameters,
    c: GatewayConstants,
    s: LockstepGateway,
    period: float,
    command: WheelTorqueCommand,
    heard: FeedbackFrames,
    shafts: BenchShafts,
    wheels: WheelStates,
) -> SetPointFrames:
    """Lead the drives over CAN frames: torque set-points out, feedback in, both guarded by counter and CRC.

    The frames of the ticks to come leave in them, one after the other; what is heard came in the ticks before.
    """
    g = s.gateway
    _command(p, g.drive_11, command.drive[int(p.wheel_11)])
    _command(p, g.drive_12, command.drive[int(p.wheel_12)])
    _watch(p, g.drive_11, int(p.wheel_11), shafts, wheels, period)
    _watch(p, g.drive_12, int(p.wheel_12), shafts, wheels, period)
    s.said[_SAID - 2] = s.said[_SAID - 1] = NO_FRAME
    for tick in range(int(c.ticks)):
        _press_buttons(c, g)
        _hear(c.frames, c.frames.drive_11, g.drive_11, heard, 0, tick)
        _hear(c.frames, c.frames.drive_12, g.drive_12, heard, _HEARD_OF_DRIVE, tick)
        before = g.tick
        advance_gateway(p, g, 1.0, TICK)
        _say(p, c.frames, c.frames.drive_11, g.drive_11, s.said, 2 * tick)
        _say(p, c.frames, c.frames.drive_12, g.drive_12, s.said, _OF_DRIVE + 2 * tick)
        if is_due(c.frames.heartbeat.ticks, before, g.tick):
            for place in range(2):
                s.said[_SAID - 2 + place] = words(heartbeat(c.frames, g, place))[0]
    s.noted[0] = float(int(s.noted[0]) | latched(g.drive_11))
    s.noted[1] = float(int(s.noted[1]) | latched(g.drive_12))
    w = s.said
    return SetPointFrames(
        w[0], w[1], w[2], w[3], w[4], w[5], w[6], w[7], w[8], w[9], w[10],
        w[11], w[12], w[13], w[14], w[15], w[16], w[17], w[18], w[19], w[20], w[21],
    )  # fmt: skip


@compilable
def _command(p: LockstepGatewayParameters, s: Device, torque: float) -> None:
    """A torque [N m] at the wheel; what is no number is no command."""
    if isfinite(torque):
        command_device(p, s, TORQUE_MODE, torque / p.gear_ratio)


@compilable
def _watch(
    p: LockstepGatewayParameters, s: Device, wheel: int, shafts: BenchShafts, wheels: WheelStates, period: float
) -> None:
    watch(p.plausibility, s, shafts.torque[wheel], shafts.speed[wheel], p.gear_ratio * wheels.velocity[wheel], period)


@compilable
def _press_buttons(c: GatewayConstants, s: Gateway) -> None:
    if s.tick == c.enable_tick:
        s.waits = 1.0
    if s.tick == c.reset_tick:
        begin_reset(s.drive_11)
        begin_reset(s.drive_12)
        s.waits = 1.0


@compilable
def _hear(f: BenchFrames, own: DeviceFrames, s: Device, heard: FeedbackFrames, begin: int, tick: int) -> None:
    """The frame of a tick, and with the first one those that come less often."""
    _take(f, own, s, MOTION, heard, begin + 2 * tick)
    if tick == 0:
        _take(f, own, s, ELECTRICAL, heard, begin + _OF_DRIVE)
        _take(f, own, s, TEMPERATURES, heard, begin + _OF_DRIVE + 2)
        _take(f, own, s, FAULTS, heard, begin + _OF_DRIVE + 4)


@compilable
def _take(f: BenchFrames, own: DeviceFrames, s: Device, kind: int, heard: FeedbackFrames, place: int) -> None:
    if are_words(heard[place], heard[place + 1]):
        receive_feedback(f, own, s.feedback, kind, joined(heard[place], heard[place + 1]))


@compilable
def _say(
    p: LockstepGatewayParameters, f: BenchFrames, own: DeviceFrames, s: Device, said: list[float], place: int
) -> None:
    said[place], said[place + 1] = words(set_point(f, own, s, p.torque_limit))
