"""The gateway as a role of the graph: orders of an instant, buttons, and frames as signals, a period at a time.

Each tick has the same steps as a cycle of `station`.
"""

from dataclasses import dataclass
from typing import NamedTuple

from ev_bench.bus.parameters import load_database
from ev_bench.inverter_gateway import leading
from ev_bench.inverter_gateway.gateway import (
    Device,
    Gateway,
    LockstepGatewayParameters,
    check_limits,
    latched,
    latched_names,
    watch,
)
from ev_core.law import (
    BenchShafts,
    Car,
    LoadCommand,
    Vehicle,
    WheelTorqueCommand,
    compilable,
    inlined,
    isfinite,
    method,
    part,
    series,
)
from ev_core.vehicle.car import listed
from ev_msgs_py.can import frames
from ev_msgs_py.can.payload import NO_FRAME, are_words, joined, words
from ev_msgs_py.contract.optional_signals import MOST_TICKS, FeedbackFrames, SetPointFrames


@inlined
def command_drives(p: LockstepGatewayParameters, g: Gateway, command: WheelTorqueCommand) -> None:
    """Torques of the drives."""
    _command(g.drive_11, frames.TORQUE_MODE, command.drive[int(p.wheel_11)] / p.gear_ratio)
    _command(g.drive_12, frames.TORQUE_MODE, command.drive[int(p.wheel_12)] / p.gear_ratio)


@inlined
def command_loads(p: LockstepGatewayParameters, g: Gateway, load: LoadCommand) -> None:
    """Torques or speeds of the load machines."""
    _command_load(g.load_11, load, int(p.wheel_11))
    _command_load(g.load_12, load, int(p.wheel_12))


@inlined
def watch_bench(
    p: LockstepGatewayParameters, rotor: float, g: Gateway, load: LoadCommand, shafts: BenchShafts, period: float
) -> None:
    """Whether the bench measures what can be, once all frames of a period have come; rotors of an inertia [kg m^2]."""
    right, left = int(p.wheel_11), int(p.wheel_12)
    watch(p.plausibility, g.drive_11, rotor, shafts.torque[right], shafts.speed[right], load.speed[right], period)
    watch(p.plausibility, g.drive_12, rotor, shafts.torque[left], shafts.speed[left], load.speed[left], period)


@compilable
def _command(s: Device, mode: int, value: float) -> None:
    """A torque [N m] or a speed [rad/s] at the shaft; what is no number is no command."""
    if isfinite(value):
        leading.command_device(s, mode, value)


@compilable
def _command_load(s: Device, load: LoadCommand, wheel: int) -> None:
    """What the virtual car asks of a load machine; in torque mode what brakes counts forwards there."""
    if int(load.mode[wheel]) == frames.SPEED_MODE:
        _command(s, frames.SPEED_MODE, load.speed[wheel])
    else:
        _command(s, frames.TORQUE_MODE, -load.torque[wheel])


@compilable
def press_buttons(enable_tick: float, reset_tick: float, g: Gateway) -> None:
    """Enable, or reset and enable after it, where the present tick is the one."""
    if g.tick == enable_tick:
        g.waits = 1.0
    if g.tick == reset_tick:
        leading.begin_reset(g.drive_11)
        leading.begin_reset(g.drive_12)
        if leading.is_faulty(g.load_11):
            leading.begin_reset(g.load_11)
        if leading.is_faulty(g.load_12):
            leading.begin_reset(g.load_12)
        g.waits = 1.0


SET_POINTS = 2 * MOST_TICKS  # words of the set-points of a device
_FEEDBACK = SET_POINTS + 6  # words of its feedback
HEARTBEATS = 2 * SET_POINTS  # where theirs stand; behind them come the set-points of the load machines
LOADS = HEARTBEATS + 2
ALL_SET_POINTS = LOADS + 2 * SET_POINTS


class GatewayConstants(NamedTuple):
    """What is computed once."""

    ticks: float  # of 1 ms in a control period
    enable_tick: float
    reset_tick: float
    frames: frames.BenchFrames


@dataclass(slots=True)
class LockstepGateway:
    """The gateway, and the frames of this period."""

    gateway: Gateway = part(Gateway)
    set_points: list[float] = series(ALL_SET_POINTS, NO_FRAME, unit="1", about="as in SetPointFrames")
    feedback: list[float] = series(4 * _FEEDBACK, NO_FRAME, unit="1", about="as in FeedbackFrames")
    noted: list[float] = series(4, unit="1", about="faults of each device since the start, as `gateway.latched`")


def prepare(parameters: LockstepGatewayParameters, _vehicle: Vehicle, period: float) -> GatewayConstants:
    """Ticks and frames; ParameterError for a control period or limits that these do not have."""
    enable_tick, reset_tick = (float(round(time / frames.TICK)) for time in (parameters.enable_at, parameters.reset_at))
    layouts = frames.bench_frames(load_database(parameters.bus.database))
    check_limits(layouts.set_point, parameters)
    return GatewayConstants(frames.ticks_of(period, MOST_TICKS), enable_tick, reset_tick, layouts)


def at_start(p: LockstepGatewayParameters) -> LockstepGateway:
    """Nothing has come and nothing is enabled yet."""
    s = LockstepGateway()
    s.gateway.waits = p.auto_enable
    return s


def circuits_fit(parameters: LockstepGatewayParameters, vehicle: Vehicle) -> str:
    """The circuits are those of the driven wheels, each on its side, behind the car's gear."""
    if {parameters.wheel_11, parameters.wheel_12} != set(vehicle.driven_wheels):
        return f"{listed((parameters.wheel_11, parameters.wheel_12))} as the only driven wheels"
    if "left" in parameters.wheel_11 or "right" in parameters.wheel_12:
        return f"wheel_11 on the right and wheel_12 on the left, not {parameters.wheel_11} and {parameters.wheel_12}"
    if parameters.gear_ratio != vehicle.gear_ratio:
        return f"a gear_ratio of {parameters.gear_ratio:g}, as its own, and not {vehicle.gear_ratio:g}"
    return ""


def notes(s: LockstepGateway) -> tuple[str, ...]:
    """The faults that were latched since the start."""
    devices = zip(("right drive", "left drive", "right load machine", "left load machine"), s.noted, strict=True)
    return tuple(f"{name}: {fault}" for name, bits in devices for fault in latched_names(int(bits)))


@method(
    "inverter_gateway",
    "can",
    prepare=prepare,
    start=at_start,
    notes=notes,
    needs=(circuits_fit,),
)
@compilable
def can(
    p: LockstepGatewayParameters,
    car: Car,
    c: GatewayConstants,
    s: LockstepGateway,
    period: float,
    command: WheelTorqueCommand,
    load: LoadCommand,
    feedback: FeedbackFrames,
    shafts: BenchShafts,
) -> SetPointFrames:
    """Lead the inverters over CAN frames: torques and speeds out, feedback in, both guarded by counter and CRC.

    The frames of the ticks to come leave in them, one after the other; feedback came in the ticks before.
    """
    g, f = s.gateway, c.frames
    s.feedback[:] = feedback
    command_drives(p, g, command)
    command_loads(p, g, load)
    s.set_points[HEARTBEATS] = s.set_points[HEARTBEATS + 1] = NO_FRAME
    for tick in range(int(c.ticks)):
        press_buttons(c.enable_tick, c.reset_tick, g)
        _hear(f, f.drive_11, g.drive_11, s, 0, tick)
        _hear(f, f.drive_12, g.drive_12, s, _FEEDBACK, tick)
        _hear(f, f.load_11, g.load_11, s, 2 * _FEEDBACK, tick)
        _hear(f, f.load_12, g.load_12, s, 3 * _FEEDBACK, tick)
        if tick == int(c.ticks) - 1:
            watch_bench(p, car.motor.rotor_inertia, g, load, shafts, period)
        before = g.tick
        leading.advance_gateway(p, g, 1.0, frames.TICK)
        _say(f, f.drive_11, g.drive_11, s, p.torque_limit, p.speed_limit, 2 * tick)
        _say(f, f.drive_12, g.drive_12, s, p.torque_limit, p.speed_limit, SET_POINTS + 2 * tick)
        _say(f, f.load_11, g.load_11, s, p.load_torque_limit, p.speed_limit, LOADS + 2 * tick)
        _say(f, f.load_12, g.load_12, s, p.load_torque_limit, p.speed_limit, LOADS + SET_POINTS + 2 * tick)
        if frames.is_due(f.heartbeat.ticks, before, g.tick):
            for place in range(2):
                s.set_points[HEARTBEATS + place] = words(leading.heartbeat(f, g, place))[0]
    note_faults(s)
    w = s.set_points
    return SetPointFrames(
        w[0], w[1], w[2], w[3], w[4], w[5], w[6], w[7], w[8], w[9], w[10],
        w[11], w[12], w[13], w[14], w[15], w[16], w[17], w[18], w[19], w[20], w[21],
        w[22], w[23], w[24], w[25], w[26], w[27], w[28], w[29], w[30], w[31],
        w[32], w[33], w[34], w[35], w[36], w[37], w[38], w[39], w[40], w[41],
    )  # fmt: skip


@compilable
def note_faults(s: LockstepGateway) -> None:
    """Keep what is latched, for `notes`."""
    s.noted[0] = float(int(s.noted[0]) | latched(s.gateway.drive_11))
    s.noted[1] = float(int(s.noted[1]) | latched(s.gateway.drive_12))
    s.noted[2] = float(int(s.noted[2]) | latched(s.gateway.load_11))
    s.noted[3] = float(int(s.noted[3]) | latched(s.gateway.load_12))


@compilable
def _hear(
    f: frames.BenchFrames, own: frames.DeviceFrames, s: Device, of: LockstepGateway, begin: int, tick: int
) -> None:
    """The frame of a tick, and with the first one those that come less often."""
    _take(f, own, s, leading.MOTION, of, begin + 2 * tick)
    if tick == 0:
        _take(f, own, s, leading.ELECTRICAL, of, begin + SET_POINTS)
        _take(f, own, s, leading.TEMPERATURES, of, begin + SET_POINTS + 2)
        _take(f, own, s, leading.FAULTS, of, begin + SET_POINTS + 4)


@compilable
def _take(
    f: frames.BenchFrames, own: frames.DeviceFrames, s: Device, kind: int, of: LockstepGateway, place: int
) -> None:
    if are_words(of.feedback[place], of.feedback[place + 1]):
        leading.receive_feedback(f, own, s.feedback, kind, joined(of.feedback[place], of.feedback[place + 1]))


@compilable
def _say(
    f: frames.BenchFrames,
    own: frames.DeviceFrames,
    s: Device,
    to: LockstepGateway,
    torque: float,
    speed: float,
    place: int,
) -> None:
    """A set-point within limits of torque [N m] and speed [rad/s]."""
    to.set_points[place], to.set_points[place + 1] = words(leading.set_point(f, own, s, torque, speed))
