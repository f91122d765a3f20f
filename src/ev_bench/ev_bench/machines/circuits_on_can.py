"""The test bench with a CAN bus between controller and inverters, as a method of `test_bench`.

How it works: in the place of torques come the words of frames, and words of frames go out
(`SetPointFrames`, `FeedbackFrames`). Between them each circuit has a channel of its own, and
`can_circuit` advances both.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from ev_bench.bus.model import channel_frames
from ev_bench.bus.parameters import load_database
from ev_bench.machines.bus_faults import measured, present
from ev_bench.machines.can_circuit import (
    SET_POINT_WORDS,
    CanConstants,
    ChannelPlace,
    Line,
    advance_can_circuit,
)
from ev_bench.machines.circuits import constants
from ev_bench.machines.circuits import outputs as outputs_of_circuits
from ev_bench.machines.circuits import prepare as prepare_circuits
from ev_bench.machines.described import KEPT_SET_POINTS, CanCircuitsParameters, CircuitsState
from ev_core.law import (
    SAME,
    WHEEL_NAMES,
    BatteryCondition,
    Car,
    ParameterError,
    Vehicle,
    Wheels,
    compilable,
    method,
    part,
    series,
)
from ev_msgs_py.can.database import Database, FrameLayout
from ev_msgs_py.can.frames import TICK, bench_frames, ticks_of
from ev_msgs_py.can.payload import NO_FRAME
from ev_msgs_py.contract.optional_signals import (
    MOST_TICKS,
    BenchElectrical,
    BenchEnergy,
    BenchShafts,
    BenchTemperatures,
    BusStates,
    FeedbackFrames,
    SetPointFrames,
)

_FRAMES = ("Faults", "Motion", "SetPoint", "Electrical", "Temperatures")  # by identifier


@dataclass(slots=True)
class CanCircuitsState(CircuitsState):
    """All circuits, and the two channels."""

    line_11: Line = part(Line)
    line_12: Line = part(Line)
    set_points: list[float] = series(
        4 * SET_POINT_WORDS + 2, NO_FRAME, unit="1", about="as in SetPointFrames"
    )


def prepare(parameters: CanCircuitsParameters, vehicle: Vehicle, period: float) -> CanConstants:
    """Compute steps and frames; ParameterError for too long a delay, and for other frames."""
    p = parameters
    for name, path in (("set_point", p.set_point), ("load_set_point", p.load_set_point)):
        if path.delay > (KEPT_SET_POINTS - 2) * TICK:
            raise ParameterError(
                f"{name}.delay: {path.delay!r} is refused, expected at most"
                f" {(KEPT_SET_POINTS - 2) * TICK:g} s"
            )
    ticks = ticks_of(period, MOST_TICKS)
    steps = max(math.ceil(TICK / p.step - 1e-9), 1)
    without_bus = prepare_circuits(p, vehicle, period).machine
    inverter = replace(without_bus, command_timeout=p.command_timeout, dc_link=p.dc_link)
    database = load_database(p.bus.database)
    # By the alphabet left is before right.
    left, right = (WHEEL_NAMES.index(name) for name in sorted(vehicle.driven_wheels))
    return CanConstants(
        constants(p, inverter, TICK / steps, int(ticks) * steps),
        ticks,
        float(steps),
        bench_frames(database),
        channel_frames(channel_layouts(database, "11")),
        channel_frames(channel_layouts(database, "12")),
        float(right),
        float(left),
    )


def channel_layouts(database: Database, circuit: str) -> list[FrameLayout]:
    """The frames of a circuit, which must stand in this order of identifiers."""
    frames = [
        database[f"{device}{circuit}_{kind}"] for kind in _FRAMES for device in ("Drive", "Load")
    ]
    frames.append(database["Ecu_Heartbeat"])
    if [frame.identifier for frame in frames] != sorted(frame.identifier for frame in frames):
        raise ParameterError(
            f"the frames of circuit {circuit} must have identifiers in the order"
            f" {', '.join(_FRAMES)}"
        )
    return frames


def two_driven(_parameters: CanCircuitsParameters, vehicle: Vehicle) -> str:
    """The two circuits are those of one axle."""
    driven = vehicle.driven_wheels
    return (
        ""
        if len(driven) == 2 and len({name.partition("_")[0] for name in driven}) == 1
        else "one driven axle"
    )


@compilable
def outputs(
    p: CanCircuitsParameters, car: Car, c: CanConstants, s: CanCircuitsState
) -> tuple[BenchShafts, BenchElectrical, BenchTemperatures, BenchEnergy, FeedbackFrames, BusStates]:
    """All channels, and what has come over the bus."""
    shafts, electrical, temperatures, energy = outputs_of_circuits(p, car, c.circuits, s)
    t = shafts.torque
    shafts = BenchShafts(
        shafts.set_point,
        shafts.machine_torque,
        Wheels(
            _said(p, c, s, 0, t[0]),
            _said(p, c, s, 1, t[1]),
            _said(p, c, s, 2, t[2]),
            _said(p, c, s, 3, t[3]),
        ),
        shafts.speed,
        shafts.load_torque,
        shafts.load_speed,
    )
    # Written out, because compiled code cannot unpack a row into a tuple.
    right, left = s.line_11.feedback, s.line_12.feedback
    frames = FeedbackFrames(
        right[0], right[1], right[2], right[3], right[4], right[5], right[6], right[7],
        right[8], right[9], right[10], right[11], right[12], right[13], right[14], right[15],
        left[0], left[1], left[2], left[3], left[4], left[5], left[6], left[7],
        left[8], left[9], left[10], left[11], left[12], left[13], left[14], left[15],
        right[16], right[17], right[18], right[19], right[20], right[21], right[22], right[23],
        right[24], right[25], right[26], right[27], right[28], right[29], right[30], right[31],
        left[16], left[17], left[18], left[19], left[20], left[21], left[22], left[23],
        left[24], left[25], left[26], left[27], left[28], left[29], left[30], left[31],
    )  # fmt: skip
    rate, all_bits = p.bus.bit_rate, c.ticks * TICK * p.bus.bit_rate
    on_right, on_left = s.line_11.channel, s.line_12.channel
    states = BusStates(
        on_right.busy / all_bits, on_right.latency / rate, on_right.lost,
        on_left.busy / all_bits, on_left.latency / rate, on_left.lost,
    )  # fmt: skip
    return shafts, electrical, temperatures, energy, frames, states


@compilable
def _said(
    p: CanCircuitsParameters, c: CanConstants, s: CanCircuitsState, wheel: int, torque: float
) -> float:
    """Torque [N m] that the transducer of a wheel measures, under the last fault."""
    channel = int(p.inject.drive)
    if wheel != int(c.right if channel == 0 else c.left):
        return torque
    # The outputs are of the end of a period: the fault of its last tick counts.
    return measured(p.inject, present(p.inject, s.periods * c.ticks - 1.0, channel), torque)


@method(
    "test_bench",
    "circuits_on_can",
    prepare=prepare,
    outputs=outputs,
    writes=(
        BenchShafts,
        BenchElectrical,
        BenchTemperatures,
        BenchEnergy,
        FeedbackFrames,
        BusStates,
    ),
    needs=(two_driven,),
    requires={
        "plant": "planar_on_bench",
        "inverter_gateway": "can",
        "inverter_gateway.bus.database": SAME,
    },
    # what is measured comes a period later than in lockstep
    in_real_time={"plant.wheel_speed": "virtual"},
    heavy=True,
)
@compilable
def circuits_on_can(
    p: CanCircuitsParameters,
    car: Car,
    c: CanConstants,
    s: CanCircuitsState,
    period: float,
    set_points: SetPointFrames,
    battery: BatteryCondition,
) -> None:
    """The same circuits, with all four inverters behind a CAN bus and CiA 402."""
    s.voltage = battery.voltage
    _say(s, set_points)
    right = ChannelPlace(0, c.frames.drive_11, c.frames.load_11, c.channel_11)
    left = ChannelPlace(1, c.frames.drive_12, c.frames.load_12, c.channel_12)
    advance_can_circuit(p, c, right, s.circuits[int(c.right)], s.line_11, s.periods)
    advance_can_circuit(p, c, left, s.circuits[int(c.left)], s.line_12, s.periods)
    s.periods += 1.0


@compilable
def _say(s: CanCircuitsState, set_points: SetPointFrames) -> None:
    """Keep the words of both circuits in records.

    A compiled function would copy a tuple of so many words with each call.
    """
    s.set_points[:] = set_points
    for place in range(SET_POINT_WORDS):
        s.line_11.set_points[place], s.line_12.set_points[place] = (
            s.set_points[place],
            s.set_points[SET_POINT_WORDS + place],
        )
        loads = 2 * SET_POINT_WORDS + 2 + place
        (
            s.line_11.set_points[SET_POINT_WORDS + place],
            s.line_12.set_points[SET_POINT_WORDS + place],
        ) = (
            s.set_points[loads],
            s.set_points[SET_POINT_WORDS + loads],
        )
    s.line_11.set_points[2 * SET_POINT_WORDS], s.line_12.set_points[2 * SET_POINT_WORDS] = (
        s.set_points[2 * SET_POINT_WORDS],
        s.set_points[2 * SET_POINT_WORDS + 1],
    )
