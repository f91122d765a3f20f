"""One circuit of the bench behind its CAN bus: set-points arrive, inverters act, feedback leaves.

How it works: a control period is a number of ticks of 1 ms. In each tick set-points are released at
its beginning, those that have arrived act at the phase of the inverters (`make_cycle`), feedback is
released there, and what has arrived at the end of the tick is kept for the gateway. `make_cycle` is
the same on a real bus (`bench_on_bus`).

State and constants are in records, which compiled code passes as one address each.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from ev_bench.bus import model as bus
from ev_bench.inverter.circuit_station import end_inverter_cycle, lead_inverter
from ev_bench.inverter.device import Inverter, InverterParameters
from ev_bench.inverter.on_channel import FAULTS, MOTION, made, receive_set_point, ticks_between
from ev_bench.machines import circuit
from ev_bench.machines.bus_faults import BusFault, BusFaultState, on_the_way, present, put_in
from ev_bench.machines.described import BOTH, LEFT, RIGHT, CanCircuitsParameters, CircuitState
from ev_core.law import compilable, part, series
from ev_msgs_py.can.drive_states import DISABLE_VOLTAGE, OPERATION_ENABLED
from ev_msgs_py.can.frames import TICK, BenchFrames, DeviceFrames, is_due
from ev_msgs_py.can.payload import NO_FRAME, are_words, joined, words
from ev_msgs_py.contract.optional_signals import MOST_TICKS

DRIVE, LOAD = range(2)  # the two devices of a channel
# Places of frames on a channel, in the order of their identifiers; those of the load machine are
# one higher.
SET_POINT, HEARTBEAT = 4, 10
PLACES_SENT = (2, 6, 8, 0)  # motion, electrical, temperatures, faults
SET_POINT_WORDS = 2 * MOST_TICKS  # words of the set-points of a device in a control period
FEEDBACK_WORDS = SET_POINT_WORDS + 6  # words of its feedback


class CanConstants(NamedTuple):
    """Constants of a circuit that are computed once."""

    circuits: circuit.CircuitsConstants
    ticks: float  # of 1 ms in a control period
    steps: float  # of the shafts in a tick
    frames: BenchFrames
    channel_11: bus.ChannelFrames
    channel_12: bus.ChannelFrames
    right: float  # place of its wheel
    left: float


@compilable
def make_cycle(
    p: CanCircuitsParameters,
    c: CanConstants,
    number: int,
    s: CircuitState,
    now: float,
    limited: bool,
) -> None:
    """Run the cycle of both inverters after their set-points: states, machines, shaft, warnings.

    The operator's enabling of a circuit is a line of its own beside the bus: without it nothing is
    switched on.
    """
    machine = c.circuits.machine
    released = p.enabled == BOTH or p.enabled == (RIGHT if number == 0 else LEFT)
    s.machine.remote = s.load.remote = 1.0 if released else 0.0
    if not released:
        s.machine.command.controlword = s.load.command.controlword = float(DISABLE_VOLTAGE)
    lead_inverter(machine, s.machine, s.speed, TICK)
    lead_inverter(p.load, s.load, s.load_speed, TICK)
    _follow(p, c, s, now, limited)
    end_inverter_cycle(machine, s.machine, TICK)
    end_inverter_cycle(p.load, s.load, TICK)


@compilable
def _follow(
    p: CanCircuitsParameters, c: CanConstants, s: CircuitState, now: float, limited: bool
) -> None:
    """Advance machines and shaft over a tick; inverters take what arrived as without a bus."""
    machine, load, path, steps = s.machine, s.load, s.torque_path, int(c.steps)
    # The command of the frames is kept aside: the steps write delayed and rate-limited values into
    # its place, and the next frame may be missing.
    asked, asked_load, asked_speed, limit = (
        machine.command.torque,
        load.command.torque,
        load.command.speed,
        load.command.torque_limit,
    )
    change = c.circuits.h * p.set_point.torque_rate
    circuit.send(
        path, now, asked, c.circuits.machine.machine.peak_torque, p.set_point.torque_resolution
    )
    circuit.send_to_load(p, s, now, -asked_load, asked_speed)
    if limited:
        load.command.torque_limit = p.inject.value
    largest = circuit.largest_torques(p, c.circuits, s)
    for n in range(steps):
        machine.command.torque = circuit.follow(path, now, steps, n, c.circuits.delay, change)
        # which is a limit beside a torque
        circuit.follow_of_load(p, c.circuits, s, now, steps, n, asked_speed)
        # Once enabled again the set-point begins to rise from none.
        if machine.state != OPERATION_ENABLED:
            path.now = 0.0
        circuit.turn_shaft(p, c.circuits, s, largest)
    machine.command.torque = asked
    load.command.torque, load.command.speed, load.command.torque_limit = (
        asked_load,
        asked_speed,
        limit,
    )


@dataclass(slots=True)
class Line:
    """A channel between controller and inverters, its frames of a control period, and a fault."""

    channel: bus.ChannelState = part(bus.ChannelState)
    fault: BusFaultState = part(BusFaultState)
    set_points: list[float] = series(
        2 * SET_POINT_WORDS + 1, NO_FRAME, unit="1", about="set-points of both devices, heartbeat"
    )
    feedback: list[float] = series(
        2 * FEEDBACK_WORDS, NO_FRAME, unit="1", about="feedback of both devices"
    )


class ChannelPlace(NamedTuple):
    """Number of the circuit: 0 for the right one, 1 for the left."""

    number: int
    drive: DeviceFrames
    load: DeviceFrames
    channel: bus.ChannelFrames


@compilable
def advance_can_circuit(
    p: CanCircuitsParameters,
    c: CanConstants,
    which: ChannelPlace,
    s: CircuitState,
    line: Line,
    periods: float,
) -> None:
    """One control period of a circuit, tick by tick."""
    circuit.begin_period(s)
    bus.next_period(line.channel)
    for place in range(2 * FEEDBACK_WORDS):
        line.feedback[place] = NO_FRAME
    for tick in range(int(c.ticks)):
        _tick(p, c, which, s, line, tick, periods * c.ticks + tick)
    circuit.end_period(p, c.circuits, s, c.ticks * TICK)


@compilable
def _tick(
    p: CanCircuitsParameters,
    c: CanConstants,
    on: ChannelPlace,
    s: CircuitState,
    line: Line,
    tick: int,
    now: float,
) -> None:
    """Release set-points, let arrived ones act at the inverters' phase, and release feedback."""
    end, phase = bus.bits_per_tick(p.bus), p.bus.phase * p.bus.bit_rate
    channel, machine = line.channel, c.circuits.machine
    kind = present(p.inject, now, on.number)
    put_in(p.inject, s.machine.injected, kind)
    _release_set_points(line, tick)
    bus.advance_channel(on.channel, p.bus, channel, on.number, phase)
    low, high = bus.take(channel, SET_POINT + DRIVE)
    arrived = on_the_way(p.inject, line.fault, kind, low, high)
    _receive(c, on.drive, s.machine, arrived.low, arrived.high)
    low, high = bus.take(channel, SET_POINT + LOAD)
    _receive(c, on.load, s.load, low, high)
    make_cycle(p, c, on.number, s, now, kind == BusFault.LOAD_LIMIT)
    for kind in range(MOTION, FAULTS + 1):
        if is_due(ticks_between(c.frames, kind), now, now + 1.0):
            _release_feedback(c, on.drive, machine, s.machine, channel, kind, DRIVE, s.speed, phase)
            _release_feedback(c, on.load, p.load, s.load, channel, kind, LOAD, s.load_speed, phase)
    bus.advance_channel(on.channel, p.bus, channel, on.number, end)
    _hear(line, tick)
    bus.next_tick(p.bus, channel)


@compilable
def _release_set_points(line: Line, tick: int) -> None:
    """Release frames of both devices, and in the first tick the heartbeat."""
    for device in range(2):
        place = SET_POINT_WORDS * device + 2 * tick
        if are_words(line.set_points[place], line.set_points[place + 1]):
            bus.release(
                line.channel,
                SET_POINT + device,
                0.0,
                line.set_points[place],
                line.set_points[place + 1],
            )
    beat = line.set_points[2 * SET_POINT_WORDS]
    if tick == 0 and are_words(beat, 0.0):
        bus.release(line.channel, HEARTBEAT, 0.0, beat, 0.0)


@compilable
def _receive(c: CanConstants, own: DeviceFrames, s: Inverter, low: float, high: float) -> None:
    if are_words(low, high):
        receive_set_point(c.frames.set_point, own, s, joined(low, high))


@compilable
def _release_feedback(
    c: CanConstants,
    own: DeviceFrames,
    p: InverterParameters,
    s: Inverter,
    channel: bus.ChannelState,
    kind: int,
    device: int,
    speed: float,
    at: float,
) -> None:
    if s.injected.silent == 0.0:
        low, high = words(made(c.frames, own, p, s, kind, speed))
        bus.release(channel, PLACES_SENT[kind] + device, at, low, high)


@compilable
def _hear(line: Line, tick: int) -> None:
    """Keep the words that have arrived; of rarer frames, a control period has the newest."""
    # Left in its place it would count as lost when the next one comes.
    bus.take(line.channel, HEARTBEAT)  # for any reader
    for device in range(2):
        for kind in range(MOTION, FAULTS + 1):
            low, high = bus.take(line.channel, PLACES_SENT[kind] + device)
            # NO_FRAME is below zero, words are not.
            if low >= 0.0:
                place = FEEDBACK_WORDS * device + (
                    2 * tick if kind == MOTION else SET_POINT_WORDS + 2 * (kind - 1)
                )
                # A rarer frame that came twice in a period: the first one is lost.
                line.channel.lost += 1.0 if line.feedback[place] >= 0.0 else 0.0
                line.feedback[place], line.feedback[place + 1] = low, high
