"""The test bench described: its parameters, and what lasts between two periods."""

from __future__ import annotations

from dataclasses import dataclass

from ev_bench.bus.model import BusModelParameters
from ev_bench.inverter.device import DcLinkParameters, Inverter, LoadInverter
from ev_bench.machines.battery_loop import BatteryLoopParameters, BatteryLoopState
from ev_bench.machines.bus_faults import BusFaultParameters
from ev_core.law import each_wheel, entry, group, parameter, part, series, setting

_ASSUMED = "assumption: not printed"
_ANY_RATE = 1e9

ENABLED_CIRCUITS = ("none", "right", "left", "both")
NONE, RIGHT, LEFT, BOTH = range(len(ENABLED_CIRCUITS))
KEPT_SET_POINTS = 64  # set-points that are kept, one for each control period


@dataclass(frozen=True, slots=True)
class SetPointParameters:
    """Response of an inverter to its set-points; by default at once and unchanged."""

    delay: float = parameter(
        0.0, unit="s", low=0.0, high=1.0, about="until a set-point acts", source=_ASSUMED
    )
    torque_rate: float = parameter(
        _ANY_RATE,
        unit="N m/s",
        low=1.0,
        high=_ANY_RATE,
        about="fastest change of a torque set-point",
        source=_ASSUMED,
    )
    speed_rate: float = parameter(
        _ANY_RATE,
        unit="rad/s^2",
        low=1.0,
        high=_ANY_RATE,
        about="fastest change of a speed set-point",
        source=_ASSUMED,
    )
    torque_resolution: float = parameter(
        0.0,
        unit="N m",
        low=0.0,
        high=10.0,
        about="step of torque set-points; 0: any value",
        source=_ASSUMED,
    )
    speed_resolution: float = parameter(
        0.0,
        unit="rad/s",
        low=0.0,
        high=10.0,
        about="step of speed set-points; 0: any value",
        source=_ASSUMED,
    )


@dataclass(frozen=True, slots=True)
class ShaftParameters:
    """Couplings and transducer between the two machines of a circuit."""

    stiffness: float = parameter(
        2e4,
        unit="N m/rad",
        low=100.0,
        high=1e8,
        about="of transducer and couplings",
        source=_ASSUMED,
    )
    damping: float = parameter(
        4.0, unit="N m s/rad", low=0.0, high=1e5, about="of the same", source=_ASSUMED
    )
    friction: float = parameter(
        0.002,
        unit="N m s/rad",
        low=0.0,
        high=10.0,
        about="of the bearings, per speed",
        source=_ASSUMED,
    )


@dataclass(frozen=True, slots=True)
class CircuitsParameters:
    """One circuit for each driven wheel, with the motor of the vehicle description under test."""

    enabled: str = setting(
        "both",
        choices=ENABLED_CIRCUITS,
        about="circuits with enabled inverters; services of the node lead it step by step",
    )
    cooling: bool = setting(
        True, about="whether the cooling is on; without it no step of the test sequence is taken"
    )
    step: float = setting(1e-3, unit="s", low=1e-6, high=1e-3, about="longest step of the shafts")
    set_point: SetPointParameters = group(SetPointParameters)
    load_set_point: SetPointParameters = group(SetPointParameters)
    least_rotor_inertia: float = parameter(
        0.005, unit="kg m^2", low=1e-4, high=100.0,
        about="of the machine under test, where the vehicle description has less",
    )  # fmt: skip
    shaft: ShaftParameters = group(ShaftParameters)
    load: LoadInverter = group(LoadInverter, speed_gain=60.0, speed_integral_time=0.05)


@dataclass(frozen=True, slots=True)
class FlowCircuitsParameters(CircuitsParameters):
    """The same devices, and the coolant loop of the battery."""

    battery_loop: BatteryLoopParameters = group(BatteryLoopParameters)


@dataclass(frozen=True, slots=True)
class CanCircuitsParameters(CircuitsParameters):
    """The same devices; set-points and feedback of the machines under test go over a bus."""

    bus: BusModelParameters = group(BusModelParameters)
    command_timeout: float = setting(
        0.01,
        unit="s",
        low=0.001,
        high=1.0,
        about="without a valid set-point for longer than this: fault",
    )
    dc_link: DcLinkParameters = group(DcLinkParameters)
    inject: BusFaultParameters = group(BusFaultParameters)


@dataclass(slots=True)
class SetPointState:
    """A set-point on its way into an inverter."""

    line: list[float] = series(
        KEPT_SET_POINTS, unit="", about="set-points of the last periods, in a ring"
    )
    now: float = entry(unit="", about="what the inverter follows")


@dataclass(slots=True)
class CircuitState:
    """Two machines with their inverters on one shaft."""

    torque_path: SetPointState = part(SetPointState)
    load_torque_path: SetPointState = part(SetPointState)
    load_speed_path: SetPointState = part(SetPointState)
    machine: Inverter = part(Inverter)
    load: Inverter = part(Inverter)
    twist: float = entry(
        unit="rad", about="of the shaft, positive where the machine under test is ahead"
    )
    speed: float = entry(unit="rad/s", about="of the machine under test, forwards positive")
    load_speed: float = entry(unit="rad/s", about="of the load machine")
    mean_torque: float = entry(unit="N m", about="of the machine under test, over the last period")
    mean_load_torque: float = entry(unit="N m", about="of the load machine, over the last period")
    mean_shaft_torque: float = entry(unit="N m", about="in the shaft, over the last period")
    power: float = entry(unit="W", about="into the inverter under test, over the last period")
    load_power: float = entry(unit="W", about="into the load inverter, over the last period")
    battery: float = entry(unit="J", about="given to the machine under test and its inverter")
    mains: float = entry(unit="J", about="taken from the mains")
    resistor: float = entry(unit="J", about="given to the load resistor")
    machine_heat: float = entry(unit="J", about="of the machine under test and its inverter")
    load_heat: float = entry(unit="J", about="of the load machine and its inverter")
    shaft_heat: float = entry(unit="J", about="of damping and friction")


@dataclass(slots=True)
class CircuitsState:
    """All circuits."""

    circuits: list[CircuitState] = each_wheel(CircuitState)
    periods: float = entry(unit="1", about="number of periods so far")
    voltage: float = entry(unit="V", about="of the battery, over the last period")


@dataclass(slots=True)
class FlowCircuitsState(CircuitsState):
    """All circuits, and the battery's loop."""

    battery_loop: BatteryLoopState = part(BatteryLoopState)
