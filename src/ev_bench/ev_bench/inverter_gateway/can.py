"""Gateway as a role of the graph: orders, buttons and frames of a period at a time.

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
    Shaft,
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

# Words in SetPointFrames and FeedbackFrames.
SET_POINTS = 2 * MOST_TICKS  # of the set-points of a device
_FEEDBACK = SET_POINTS + 6  # of its feedback
HEARTBEATS = 2 * SET_POINTS  # place of the heartbeats, behind the set-points of the drives
LOADS = HEARTBEATS + 2  # place of the set-points of the load machines
ALL_SET_POINTS = LOADS + 2 * SET_POINTS
# In the order of `noted`.
_DEVICES = ("right drive", "left drive", "right load machine", "left load machine")
_PATIENCE = 2.0  # s; the slowest pre-charge that is no fault takes so long


@inlined
def command_drives(p: LockstepGatewayParameters, g: Gateway, command: WheelTorqueCommand) -> None:
    """Take the torques of the drives."""
    _command(g.drive_11, frames.TORQUE_MODE, command.drive[int(p.wheel_11)] / p.gear_ratio)
    _command(g.drive_12, frames.TORQUE_MODE, command.drive[int(p.wheel_12)] / p.gear_ratio)


@inlined
def command_loads(p: LockstepGatewayParameters, g: Gateway, load: LoadCommand) -> None:
    """Take the torques or speeds of the load machines."""
    _command_load(g.load_11, load, int(p.wheel_11))
    _command_load(g.load_12, load, int(p.wheel_12))


@inlined
def watch_bench(
    p: LockstepGatewayParameters,
    rotor: float,
    g: Gateway,
    load: LoadCommand,
    shafts: BenchShafts,
    period: float,
) -> None:
    """Check what the bench measures, once all frames of a period have come.

    `rotor` is the inertia of the rotors [kg m^2].
    """
    i, j = int(p.wheel_11), int(p.wheel_12)
    right = Shaft(rotor, shafts.torque[i], shafts.speed[i], load.speed[i])
    left = Shaft(rotor, shafts.torque[j], shafts.speed[j], load.speed[j])
    watch(p.plausibility, g.drive_11, right, period)
    watch(p.plausibility, g.drive_12, left, period)


@compilable
def _command(s: Device, mode: int, value: float) -> None:
    """Command a torque [N m] or a speed [rad/s] at the shaft, unless it is no number."""
    if isfinite(value):
        leading.command_device(s, mode, value)


@compilable
def _command_load(s: Device, load: LoadCommand, wheel: int) -> None:
    """Command a load machine; in torque mode what brakes the car counts forwards there."""
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


class GatewayConstants(NamedTuple):
    """Numbers that are computed once."""

    ticks: float  # of 1 ms in a control period
    enable_tick: float
    reset_tick: float
    frames: frames.BenchFrames


@dataclass(slots=True)
class LockstepGateway:
    """The gateway, and the frames of this period."""

    gateway: Gateway = part(Gateway)
    set_points: list[float] = series(
        ALL_SET_POINTS, NO_FRAME, unit="1", about="as in SetPointFrames"
    )
    feedback: list[float] = series(4 * _FEEDBACK, NO_FRAME, unit="1", about="as in FeedbackFrames")
    noted: list[float] = series(
        4, unit="1", about="faults of each device since the start, as `gateway.latched`"
    )


def prepare(
    parameters: LockstepGatewayParameters, _vehicle: Vehicle, period: float
) -> GatewayConstants:
    """Ticks and frames; ParameterError for a control period or limits that these do not have."""
    enable_tick = float(round(parameters.enable_at / frames.TICK))
    reset_tick = float(round(parameters.reset_at / frames.TICK))
    layouts = frames.bench_frames(load_database(parameters.bus.database))
    check_limits(layouts.set_point, parameters)
    ticks = frames.ticks_of(period, MOST_TICKS)
    return GatewayConstants(ticks, enable_tick, reset_tick, layouts)


def at_start(p: LockstepGatewayParameters) -> LockstepGateway:
    """State of a gateway to which nothing has come yet, and which has enabled nothing."""
    s = LockstepGateway()
    s.gateway.waits = p.auto_enable
    return s


def circuits_fit(parameters: LockstepGatewayParameters, vehicle: Vehicle) -> str:
    """Refuse circuits that are not those of the driven wheels, behind the gear of the car."""
    if {parameters.wheel_11, parameters.wheel_12} != set(vehicle.driven_wheels):
        return f"{listed((parameters.wheel_11, parameters.wheel_12))} as the only driven wheels"
    if "left" in parameters.wheel_11 or "right" in parameters.wheel_12:
        given = f"{parameters.wheel_11} and {parameters.wheel_12}"
        return f"wheel_11 on the right and wheel_12 on the left, not {given}"
    if parameters.gear_ratio != vehicle.gear_ratio:
        return (
            f"a gear_ratio of {parameters.gear_ratio:g}, as its own, and not {vehicle.gear_ratio:g}"
        )
    return ""


def notes(s: LockstepGateway) -> tuple[str, ...]:
    """Faults that were latched since the start, and drives that could not be enabled."""
    found = []
    # As on a bus that is too slow: the car stands still, and its metrics show no reason.
    if s.gateway.waited > _PATIENCE:
        found.append(f"the drives waited for more than {_PATIENCE:g} s to be enabled")
    for name, bits in zip(_DEVICES, s.noted, strict=True):
        found += [f"{name}: {fault}" for fault in latched_names(int(bits))]
    return tuple(found)


class GatewaySeen(NamedTuple):
    """Signals that the gateway reads."""

    command: WheelTorqueCommand
    load: LoadCommand
    feedback: FeedbackFrames
    shafts: BenchShafts


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
    seen: GatewaySeen,
) -> SetPointFrames:
    """Lead the inverters over CAN frames, guarded by counter and CRC both ways.

    The frames of the ticks to come leave in them, one after the other; feedback came in the ticks
    before.
    """
    g = s.gateway
    f = c.frames
    load = seen.load
    s.feedback[:] = seen.feedback
    command_drives(p, g, seen.command)
    command_loads(p, g, load)
    of_drives = leading.Limits(p.torque_limit, p.speed_limit)
    of_loads = leading.Limits(p.load_torque_limit, p.speed_limit)
    # The set-points are all written below; a heartbeat may be due or not.
    s.set_points[HEARTBEATS] = s.set_points[HEARTBEATS + 1] = NO_FRAME
    for tick in range(int(c.ticks)):
        press_buttons(c.enable_tick, c.reset_tick, g)
        _receive(f, f.drive_11, g.drive_11, s, 0, tick)
        _receive(f, f.drive_12, g.drive_12, s, _FEEDBACK, tick)
        _receive(f, f.load_11, g.load_11, s, 2 * _FEEDBACK, tick)
        _receive(f, f.load_12, g.load_12, s, 3 * _FEEDBACK, tick)
        # Now all feedback of the period has come.
        if tick == int(c.ticks) - 1:
            watch_bench(p, car.motor.rotor_inertia, g, load, seen.shafts, period)
        before = g.tick
        leading.advance_gateway(p, g, 1.0, frames.TICK)
        _put(s, 2 * tick, leading.set_point(f, f.drive_11, g.drive_11, of_drives))
        _put(s, SET_POINTS + 2 * tick, leading.set_point(f, f.drive_12, g.drive_12, of_drives))
        _put(s, LOADS + 2 * tick, leading.set_point(f, f.load_11, g.load_11, of_loads))
        place = LOADS + SET_POINTS + 2 * tick
        _put(s, place, leading.set_point(f, f.load_12, g.load_12, of_loads))
        if frames.is_due(f.heartbeat.ticks, before, g.tick):
            for side in range(2):
                s.set_points[HEARTBEATS + side] = words(leading.heartbeat(f, g, side))[0]
    note_faults(s)
    w = s.set_points
    return SetPointFrames(
        # Written out, because compiled code cannot unpack a row into a tuple.
        w[0],
        w[1],
        w[2],
        w[3],
        w[4],
        w[5],
        w[6],
        w[7],
        w[8],
        w[9],
        w[10],
        w[11],
        w[12],
        w[13],
        w[14],
        w[15],
        w[16],
        w[17],
        w[18],
        w[19],
        w[20],
        w[21],
        w[22],
        w[23],
        w[24],
        w[25],
        w[26],
        w[27],
        w[28],
        w[29],
        w[30],
        w[31],
        w[32],
        w[33],
        w[34],
        w[35],
        w[36],
        w[37],
        w[38],
        w[39],
        w[40],
        w[41],
    )


@compilable
def note_faults(s: LockstepGateway) -> None:
    """Keep what is latched, for `notes`."""
    s.noted[0] = float(int(s.noted[0]) | latched(s.gateway.drive_11))
    s.noted[1] = float(int(s.noted[1]) | latched(s.gateway.drive_12))
    s.noted[2] = float(int(s.noted[2]) | latched(s.gateway.load_11))
    s.noted[3] = float(int(s.noted[3]) | latched(s.gateway.load_12))


@compilable
def _receive(
    f: frames.BenchFrames,
    own: frames.DeviceFrames,
    s: Device,
    of: LockstepGateway,
    begin: int,
    tick: int,
) -> None:
    """Take the frame of a tick, and with the first one those that come less often."""
    _take(f, own, s, leading.MOTION, of, begin + 2 * tick)
    # The lockstep bus hands over the newest of the rarer frames once for the whole period.
    if tick == 0:
        _take(f, own, s, leading.ELECTRICAL, of, begin + SET_POINTS)
        _take(f, own, s, leading.TEMPERATURES, of, begin + SET_POINTS + 2)
        _take(f, own, s, leading.FAULTS, of, begin + SET_POINTS + 4)


@compilable
def _take(
    f: frames.BenchFrames,
    own: frames.DeviceFrames,
    s: Device,
    kind: int,
    of: LockstepGateway,
    place: int,
) -> None:
    if are_words(of.feedback[place], of.feedback[place + 1]):
        leading.receive_feedback(
            f, own, s.feedback, kind, joined(of.feedback[place], of.feedback[place + 1])
        )


@compilable
def _put(to: LockstepGateway, place: int, payload: int) -> None:
    """Put a set-point into the frames that go out."""
    to.set_points[place], to.set_points[place + 1] = words(payload)
