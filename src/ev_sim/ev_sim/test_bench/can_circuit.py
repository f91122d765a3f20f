"""One circuit of the bench behind its CAN bus: set-points arrive, the inverter makes its cycles, feedback leaves."""

from __future__ import annotations

from typing import NamedTuple

from ev_msgs_py.can.bus_model import (
    UNKNOWN,
    ChannelFrames,
    ChannelState,
    advance_channel,
    bits_per_tick,
    next_tick,
    release,
    take,
)
from ev_msgs_py.can.drive_states import OPERATION_ENABLED
from ev_msgs_py.can.frames import NO_FRAME, BenchFrames, DeviceFrames, are_words, joined, words
from ev_msgs_py.can.schedule import TICK, is_due
from ev_msgs_py.can.wire_time import WireTables
from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.bus_signals import MOST_TICKS, SetPointFrames
from ev_sim.inverter.frames import FAULTS, MOTION, is_sent, made, ticks_between
from ev_sim.inverter.inverter import end_inverter_cycle, lead_inverter
from ev_sim.inverter.set_points import receive_set_point
from ev_sim.inverter.state import Inverter
from ev_sim.inverter.temperatures import advance_temperatures
from ev_sim.inverter.torque import advance_electrical
from ev_sim.test_bench.bus_faults import FaultState, on_the_way, present, put_in
from ev_sim.test_bench.can_parameters import CanCircuitsParameters
from ev_sim.test_bench.circuit import CircuitsConstants, CircuitSetPoint, begin_period, largest_torques, turn_shaft
from ev_sim.test_bench.set_points import follow, send
from ev_sim.test_bench.state import CircuitState

# Places of frames on a channel, in the order of their identifiers; those of the load machine are one higher.
SET_POINT, HEARTBEAT = 4, 10
PLACES_SENT = (2.0, 6.0, 8.0, 0.0)  # motion, electrical, temperatures, faults
SAID_OF_DRIVE = 2 * MOST_TICKS  # words of its set-points in SetPointFrames
HEARD_OF_DRIVE = SAID_OF_DRIVE + 6  # words of its feedback in FeedbackFrames


class CanConstants(NamedTuple):
    """What is computed once."""

    circuits: CircuitsConstants
    ticks: float  # of 1 ms in a control period
    steps: float  # of the shafts in a tick
    frames: BenchFrames
    channel_11: ChannelFrames
    channel_12: ChannelFrames
    tables: WireTables
    right: float  # place of its wheel
    left: float


class Circuit(NamedTuple):
    """Which circuit it is: 0 for the right one and 1 for the left."""

    number: int
    own: DeviceFrames
    channel: ChannelFrames


@compilable
def advance_can_circuit(
    p: CanCircuitsParameters,
    c: CanConstants,
    which: Circuit,
    s: CircuitState,
    channel: ChannelState,
    fault: FaultState,
    heard: list[float],
    periods: float,
    said: SetPointFrames,
    told: CircuitSetPoint,
) -> None:
    """One control period of a circuit, tick by tick; `heard` gets the feedback that has arrived."""
    begin_period(p, s, periods, told)
    channel.busy = channel.latency = 0.0
    begin = which.number * HEARD_OF_DRIVE
    for place in range(HEARD_OF_DRIVE):
        heard[begin + place] = NO_FRAME
    for tick in range(int(c.ticks)):
        _tick(p, c, which, s, channel, fault, heard, periods, said, tick)
    advance_electrical(p.load, s.load, s.load_speed)
    advance_temperatures(p.load.thermal, p.load.machine, s.load, c.ticks * TICK)


@compilable
def _tick(
    p: CanCircuitsParameters,
    c: CanConstants,
    which: Circuit,
    s: CircuitState,
    channel: ChannelState,
    fault: FaultState,
    heard: list[float],
    periods: float,
    said: SetPointFrames,
    tick: int,
) -> None:
    """Set-points are released, those that have arrived by the inverter's phase act, feedback is released, arrives."""
    before = periods * c.ticks + tick
    end, phase = bits_per_tick(p.bus), p.bus.phase * p.bus.bit_rate
    kind = present(p.inject, before, which.number)
    put_in(p.inject, s, kind)
    _release_set_points(which, channel, said, tick)
    advance_channel(which.channel, c.tables, p.bus, channel, which.number, phase)
    low, high = take(channel, SET_POINT, phase)
    arrived = on_the_way(p.inject, fault, kind, low, high)
    if are_words(arrived.low, arrived.high):
        receive_set_point(c.frames.set_point, which.own, s.machine, joined(arrived.low, arrived.high))
    lead_inverter(c.circuits.machine, s.machine, s.speed, TICK)
    _follow(p, c, s, periods, tick)
    end_inverter_cycle(c.circuits.machine, s.machine, TICK)
    _release_feedback(c, which, s.machine, channel, s.speed, before, phase)
    advance_channel(which.channel, c.tables, p.bus, channel, which.number, end)
    _hear(which, channel, heard, tick, end)
    next_tick(p.bus, channel)


@compilable
def _release_set_points(which: Circuit, channel: ChannelState, said: SetPointFrames, tick: int) -> None:
    """Of the drive, of the load machine, which the virtual car leads by itself, and in the first tick the heartbeat."""
    begin = which.number * SAID_OF_DRIVE + 2 * tick
    if are_words(said[begin], said[begin + 1]):
        release(channel, SET_POINT, 0.0, said[begin], said[begin + 1])
    release(channel, SET_POINT + 1, 0.0, UNKNOWN, 0.0)
    beat = said[2 * SAID_OF_DRIVE + which.number]
    if tick == 0 and are_words(beat, 0.0):
        release(channel, HEARTBEAT, 0.0, beat, 0.0)


@compilable
def _follow(p: CanCircuitsParameters, c: CanConstants, s: CircuitState, periods: float, tick: int) -> None:
    """The machines and the shaft over a tick; the inverter takes what has arrived as it would without a bus."""
    asked, path, steps = s.machine.command.torque, s.torque_path, int(c.steps)
    now, change = periods * c.ticks + tick, c.circuits.h * p.set_point.torque_rate
    send(path, now, asked, c.circuits.machine.machine.peak_torque, p.set_point.torque_resolution)
    largest = largest_torques(p, c.circuits, s)
    for n in range(steps):
        s.machine.command.torque = follow(path, now, steps, n, c.circuits.delay, change)
        if s.machine.state != OPERATION_ENABLED:
            path.now = 0.0
        turn_shaft(p, c.circuits, s, periods, tick * steps + n, largest)
    advance_electrical(c.circuits.machine, s.machine, s.speed)
    s.machine.command.torque = asked


@compilable
def _release_feedback(
    c: CanConstants, which: Circuit, s: Inverter, channel: ChannelState, speed: float, before: float, at: float
) -> None:
    for kind in range(MOTION, FAULTS + 1):
        place = int(PLACES_SENT[kind])
        if is_sent(c.frames, s, kind, before, before + 1.0):
            low, high = words(made(c.frames, which.own, c.circuits.machine, s, kind, speed))
            release(channel, place, at, low, high)
        if is_due(ticks_between(c.frames, kind), before, before + 1.0):
            release(channel, place + 1, at, UNKNOWN, 0.0)


@compilable
def _hear(which: Circuit, channel: ChannelState, heard: list[float], tick: int, end: float) -> None:
    """Keep the words of what has arrived in its place of FeedbackFrames."""
    begin = which.number * HEARD_OF_DRIVE
    for kind in range(MOTION, FAULTS + 1):
        low, high = take(channel, int(PLACES_SENT[kind]), end)
        place = begin + 2 * tick if kind == MOTION else begin + SAID_OF_DRIVE + 2 * (kind - 1)
        if low >= 0.0:
            heard[place], heard[place + 1] = low, high
