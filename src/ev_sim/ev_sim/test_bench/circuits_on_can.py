"""The test bench with a CAN bus between controller and inverters, as a method of the role `test_bench`."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from ev_msgs_py.can.bus_model import ChannelState, channel_frames
from ev_msgs_py.can.database import Database, load_database
from ev_msgs_py.can.drive_states import OPERATION_ENABLED
from ev_msgs_py.can.frame_layout import FrameLayout
from ev_msgs_py.can.frames import NO_FRAME, bench_frames
from ev_msgs_py.can.schedule import TICK, ticks_of
from ev_msgs_py.can.wire_time import wire_tables
from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.bench_signals import BenchElectrical, BenchEnergy, BenchShafts, BenchTemperatures, LoadCommand
from ev_msgs_py.contract.bus_signals import MOST_TICKS, BusStates, FeedbackFrames, SetPointFrames
from ev_msgs_py.contract.record import part, series
from ev_msgs_py.contract.signals import BatteryCondition
from ev_msgs_py.contract.wheels import WHEEL_NAMES, Wheels
from ev_msgs_py.lockstep.methods import method
from ev_msgs_py.parameters.declaration import ParameterError
from ev_msgs_py.vehicle.car import Car
from ev_msgs_py.vehicle.description import Vehicle
from ev_sim.test_bench.bus_faults import FaultState, measured, present
from ev_sim.test_bench.can_circuit import HEARD_OF_DRIVE, CanConstants, Circuit, advance_can_circuit
from ev_sim.test_bench.can_parameters import CanCircuitsParameters
from ev_sim.test_bench.circuit import CircuitSetPoint
from ev_sim.test_bench.circuits import constants
from ev_sim.test_bench.circuits import outputs as outputs_of_circuits
from ev_sim.test_bench.circuits import prepare as prepare_circuits
from ev_sim.test_bench.state import LINE, CircuitsState

_FRAMES = ("Faults", "Motion", "SetPoint", "Electrical", "Temperatures")  # by identifier


@dataclass(slots=True)
class CanCircuitsState(CircuitsState):
    """All circuits, and the two channels."""

    channel_11: ChannelState = part(ChannelState)
    channel_12: ChannelState = part(ChannelState)
    fault_11: FaultState = part(FaultState)
    fault_12: FaultState = part(FaultState)
    heard: list[float] = series(2 * HEARD_OF_DRIVE, NO_FRAME, unit="1", about="as in FeedbackFrames")


def prepare(parameters: CanCircuitsParameters, vehicle: Vehicle, period: float) -> CanConstants:
    """Steps and frames; ParameterError for a delay of more ticks than are kept, and for other frames."""
    p = parameters
    if p.set_point.delay > (LINE - 2) * TICK:
        raise ParameterError(
            f"set_point.delay: {p.set_point.delay!r} is refused, allowed is at most {(LINE - 2) * TICK:g} s"
        )
    ticks = ticks_of(period, MOST_TICKS)
    steps = max(math.ceil(TICK / p.step - 1e-9), 1)
    without_bus = prepare_circuits(p, vehicle, period).machine
    inverter = replace(without_bus, command_timeout=p.command_timeout, dc_link=p.dc_link)
    database = load_database(p.database)
    left, right = (WHEEL_NAMES.index(name) for name in sorted(vehicle.driven_wheels))
    return CanConstants(
        constants(p, inverter, TICK / steps, int(ticks) * steps),
        ticks,
        float(steps),
        bench_frames(database),
        channel_frames(_of_channel(database, "11")),
        channel_frames(_of_channel(database, "12")),
        wire_tables(),
        float(right),
        float(left),
    )


def _of_channel(database: Database, circuit: str) -> list[FrameLayout]:
    """The frames of a circuit, which must stand in this order of identifiers."""
    frames = [database[f"{device}{circuit}_{kind}"] for kind in _FRAMES for device in ("Drive", "Load")]
    frames.append(database["Ecu_Heartbeat"])
    if [frame.identifier for frame in frames] != sorted(frame.identifier for frame in frames):
        raise ParameterError(f"the frames of circuit {circuit} must have identifiers in the order {', '.join(_FRAMES)}")
    return frames


def two_driven(_parameters: CanCircuitsParameters, vehicle: Vehicle) -> str:
    """The two circuits are those of one axle."""
    driven = vehicle.driven_wheels
    return "" if len(driven) == 2 and len({name.partition("_")[0] for name in driven}) == 1 else "one driven axle"


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
        Wheels(_said(p, c, s, 0, t[0]), _said(p, c, s, 1, t[1]), _said(p, c, s, 2, t[2]), _said(p, c, s, 3, t[3])),
        shafts.speed,
        shafts.load_torque,
        shafts.load_speed,
    )
    w = s.heard
    frames = FeedbackFrames(
        w[0], w[1], w[2], w[3], w[4], w[5], w[6], w[7], w[8], w[9], w[10], w[11], w[12], w[13], w[14], w[15],
        w[16], w[17], w[18], w[19], w[20], w[21], w[22], w[23], w[24], w[25], w[26], w[27], w[28], w[29], w[30], w[31],
    )  # fmt: skip
    rate, all_bits = p.bus.bit_rate, c.ticks * TICK * p.bus.bit_rate
    right, left = s.channel_11, s.channel_12
    states = BusStates(
        right.busy / all_bits, right.latency / rate, right.lost, left.busy / all_bits, left.latency / rate, left.lost
    )
    return shafts, electrical, temperatures, energy, frames, states


@compilable
def _said(p: CanCircuitsParameters, c: CanConstants, s: CanCircuitsState, wheel: int, torque: float) -> float:
    """What the transducer of a wheel says of a torque [N m], with the fault that was there last."""
    channel = int(p.inject.drive)
    if wheel != int(c.right if channel == 0 else c.left):
        return torque
    return measured(p.inject, present(p.inject, s.periods * c.ticks - 1.0, channel), torque)


@method(
    "test_bench",
    "circuits_on_can",
    CanCircuitsParameters,
    state=CanCircuitsState,
    prepare=prepare,
    outputs=outputs,
    writes=(BenchShafts, BenchElectrical, BenchTemperatures, BenchEnergy, FeedbackFrames, BusStates),
    needs=(two_driven,),
    requires={"plant": "planar_on_bench", "inverter_gateway": "can"},
    heavy=True,
)
@compilable
def circuits_on_can(
    p: CanCircuitsParameters,
    car: Car,
    c: CanConstants,
    s: CanCircuitsState,
    period: float,
    said: SetPointFrames,
    load: LoadCommand,
    battery: BatteryCondition,
) -> None:
    """The same circuits, with the torque set-points of the machines under test behind a CAN bus and CiA 402.

    What the virtual car asks of the load machines goes to them directly; their frames are on the bus as load.
    """
    s.voltage = battery.voltage
    right, left = int(c.right), int(c.left)
    _advance(p, c, s, Circuit(0, c.frames.drive_11, c.channel_11), right, said, load)
    _advance(p, c, s, Circuit(1, c.frames.drive_12, c.channel_12), left, said, load)
    s.periods += 1.0


@compilable
def _advance(
    p: CanCircuitsParameters, c: CanConstants, s: CanCircuitsState, which: Circuit, wheel: int, said: SetPointFrames,
    load: LoadCommand,
) -> None:  # fmt: skip
    own = s.circuits[wheel]
    own.load.state, own.load.dc_link.voltage = float(OPERATION_ENABLED), p.load.dc_link.supply_voltage
    told = CircuitSetPoint(0.0, load.mode[wheel], load.torque[wheel], load.speed[wheel])
    if which.number == 0:
        advance_can_circuit(p, c, which, own, s.channel_11, s.fault_11, s.heard, s.periods, said, told)
    else:
        advance_can_circuit(p, c, which, own, s.channel_12, s.fault_12, s.heard, s.periods, said, told)
