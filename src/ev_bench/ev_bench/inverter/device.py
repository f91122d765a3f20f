"""The devices of the bench: their parameters, their states, and faults that are set by name.

How it works: the state of all devices is in records, their parameters are in dataclasses; compiled
code gets both as numbers. A load machine is a machine under test with other defaults (`_as_in`). A
fault from outside is an entry of `Injected`, which the other modules read at the place where it
acts.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass, fields
from types import MappingProxyType
from typing import Any

from ev_bench.bus.checking import CheckState
from ev_bench.bus.parameters import BusParameters
from ev_core.law import ParameterError, entry, group, parameter, part, series, setting
from ev_core.parameters.declaration import entries
from ev_core.vehicle.motor import ThermalParameters, Winding
from ev_msgs_py.can.frames import LONG_AGO

# Entry of `Injected` and the value that makes a fault of it, with the thresholds of the default
# parameters.
INJECTIONS = MappingProxyType(
    {
        "trip": ("trip", 1.0),
        "dc_link_loss": ("supply_lost", 1.0),
        "hot_winding": ("winding_rise", 120.0),
        "hot_inverter": ("inverter_rise", 80.0),
        "over_voltage": ("voltage_rise", 200.0),
        "over_current": ("current_rise", 700.0),
        "silent": ("silent", 1.0),
        "wrong_crc": ("wrong_crc", 1.0),
        "frozen_counter": ("frozen_counter", 1.0),
    }
)
_TABLE = "dissertation, table 1.1"
_ASSUMED = "assumption, as in the vehicle dissertation_class_b"
_LOST = (
    "data of the 1PV5138-4WS24 are lost in the source: assumed to hold the machine under test up to"
    " 10000 rpm"
)
_CELLS = "103 cells in series at 3.2 V; the voltage is not printed: assumption"


@dataclass(slots=True)
class Command:
    """The newest valid set-point."""

    controlword: float = entry(unit="1")
    mode: float = entry(unit="1")
    direction: float = entry(unit="1")
    torque: float = entry(unit="N m")
    speed: float = entry(unit="rad/s")
    torque_limit: float = entry(unit="N m")
    reset: float = entry(
        unit="1", about="the reset bit has risen, and nothing forbids it; until the next cycle"
    )


@dataclass(slots=True)
class Supervision:
    """Times and counts since the newest valid set-point."""

    age: float = entry(LONG_AGO, unit="s", about="of the newest valid set-point")
    wrong_crc: float = entry(unit="1", about="frames with a wrong CRC since then")
    wrong_counter: float = entry(
        unit="1", about="frames with a repeated or wrong counter since then"
    )
    refused_age: float = entry(LONG_AGO, unit="s", about="of the newest frame that was refused")
    lost_age: float = entry(LONG_AGO, unit="s", about="since frames were lost that were tolerated")
    heard: float = entry(unit="1", about="whether a set-point has come in this cycle")


@dataclass(slots=True)
class DcLink:
    """The capacitor between supply and power stage."""

    voltage: float = entry(unit="V")
    contactor: float = entry(unit="1", about="closed or not")
    charging_time: float = entry(unit="s")


@dataclass(slots=True)
class Temperatures:
    """Above the coolant inlet, so that everything starts cold."""

    winding: float = entry(unit="K")
    inverter: float = entry(unit="K")


@dataclass(slots=True)
class Injected:
    """Faults that are put in from outside."""

    trip: float = entry(unit="1", about="the power stage trips")
    supply_lost: float = entry(unit="1", about="the contactor drops out")
    winding_rise: float = entry(unit="K", about="added to the winding temperature")
    inverter_rise: float = entry(unit="K", about="added to the temperature of the power stage")
    voltage_rise: float = entry(unit="V", about="added to the voltage of the DC link")
    current_rise: float = entry(unit="A", about="added to the phase current")
    silent: float = entry(unit="1", about="sends nothing")
    wrong_crc: float = entry(unit="1", about="sends a wrong CRC")
    frozen_counter: float = entry(unit="1", about="sends the same counter again and again")


@dataclass(slots=True)
class Inverter:
    """One inverter and its machine."""

    check: CheckState = part(CheckState)
    command: Command = part(Command)
    supervision: Supervision = part(Supervision)
    dc_link: DcLink = part(DcLink)
    temperatures: Temperatures = part(Temperatures)
    injected: Injected = part(Injected)
    remote: float = entry(
        1.0, unit="1", about="whether it follows its controlword: the operator's line releases it"
    )
    state: float = entry(unit="1", about="place in STATE_NAMES")
    faults: float = entry(unit="1", about="latched, bits by place in FAULTS")
    error_code: float = entry(unit="1", about="of the first fault that was latched")
    warnings: float = entry(unit="1", about="present, bits by place in WARNINGS")
    direction: float = entry(unit="1", about="sense of set-points that was taken over")
    limited: float = entry(unit="1", about="whether the torque is less than was asked for")
    speed_integral: float = entry(unit="N m", about="speed mode: integral part")
    torque: float = entry(unit="N m", about="at the shaft, forwards positive")
    phase_current: float = entry(unit="A", about="rms")
    phase_voltage: float = entry(unit="V", about="phase to neutral, rms")
    weakening_loss: float = entry(
        unit="W", about="copper loss of the current that weakens the magnets"
    )
    dc_current: float = entry(unit="A", about="from the supply")
    counters: list[float] = series(
        4, unit="1", about="of the next frame of each kind, in the order of SENT"
    )


@dataclass(slots=True)
class Circuit:
    """A machine under test and a load machine on one shaft."""

    drive: Inverter = part(Inverter)
    load: Inverter = part(Inverter)
    speed: float = entry(unit="rad/s", about="of the shaft, forwards positive")
    tick: float = entry(unit="1", about="cycles of 1 ms since the start")


def inject(s: Injected, names: Iterable[str]) -> None:
    """Put these faults in, and take all others away."""
    for field in fields(s):
        setattr(s, field.name, 0.0)
    for name in names:
        entry, value = INJECTIONS[name]
        setattr(s, entry, value)


@dataclass(frozen=True, slots=True)
class Machine:
    """The machine under test, a YASA-400."""

    peak_torque: float = parameter(
        360.0, unit="N m", low=0.0, high=1000.0, about="at the shaft", source=_TABLE
    )
    nominal_torque: float = parameter(
        250.0,
        unit="N m",
        low=1e-3,
        high=1000.0,
        about="at the shaft; temperatures decide for how long",
        source=_TABLE,
    )
    peak_power: float = parameter(
        150e3, unit="W", low=1.0, high=1e7, about="mechanical", source=_TABLE
    )
    maximum_speed: float = parameter(
        785.398,
        unit="rad/s",
        low=1.0,
        high=1047.2,
        about="of the shaft; no drive torque beyond",
        source=_TABLE,
    )
    generator_torque: float = parameter(
        360.0, unit="N m", low=0.0, high=1000.0, about="largest torque against the speed"
    )
    generator_power: float = parameter(
        150e3, unit="W", low=0.0, high=1e7, about="largest power from the shaft"
    )
    torque_lag: float = parameter(
        0.002, unit="s", low=1e-4, high=10.0, about="time constant of the torque control"
    )
    rotor_inertia: float = parameter(
        0.02, unit="kg m^2", low=1e-4, high=100.0, about="of the rotor"
    )
    copper_loss: float = parameter(
        0.045, unit="W/(N m)^2", low=0.0, high=1e3, about="loss per squared torque", source=_ASSUMED
    )
    iron_loss: float = parameter(
        1.0, unit="W s/rad", low=0.0, high=1e3, about="loss per speed", source=_ASSUMED
    )
    eddy_loss: float = parameter(
        1e-3,
        unit="W s^2/rad^2",
        low=0.0,
        high=10.0,
        about="loss per squared speed",
        source=_ASSUMED,
    )
    inverter_loss: float = parameter(
        60.0, unit="W", low=0.0, high=1e4, about="loss without torque", source=_ASSUMED
    )
    inverter_torque_loss: float = parameter(
        2.0, unit="W/(N m)", low=0.0, high=100.0, about="loss per torque", source=_ASSUMED
    )
    winding: Winding = group(Winding)


def _as_in(of: type, name: str, **changed: Any) -> Any:
    """Declare a parameter of another dataclass with another default or other knowledge."""
    # Exactly one: a name that the other dataclass no longer has fails as this module is read.
    (known,) = (each for each in entries(of) if each.name == name)
    return parameter(**{"default": known.default, **asdict(known.spec), **changed})


@dataclass(frozen=True, slots=True)
class LoadMachine(Machine):
    """The asynchronous load machine; its limits by voltage are those of a synchronous one."""

    peak_torque: float = _as_in(Machine, "peak_torque", default=400.0, source=_LOST)
    nominal_torque: float = _as_in(Machine, "nominal_torque", source=_LOST)
    peak_power: float = _as_in(Machine, "peak_power", source=_LOST)
    maximum_speed: float = _as_in(Machine, "maximum_speed", default=1047.0, source=_LOST)
    generator_torque: float = _as_in(Machine, "generator_torque", default=400.0, source=_LOST)
    torque_lag: float = _as_in(Machine, "torque_lag", default=0.001, source=_LOST)
    rotor_inertia: float = _as_in(Machine, "rotor_inertia", default=0.1, source=_LOST)
    winding: Winding = group(Winding, inductance=5e-5, largest_current=505.0)


@dataclass(frozen=True, slots=True)
class DcLinkParameters:
    """Supply, capacitor and pre-charge of an inverter."""

    supply_voltage: float = parameter(
        329.6, unit="V", low=10.0, high=1000.0, about="of the supply", source=_CELLS
    )
    capacitance: float = parameter(
        440e-6,
        unit="F",
        low=1e-6,
        high=0.1,
        about="of the DC link",
        source="assumption for an inverter of 150 kW",
    )
    precharge_resistance: float = parameter(
        600.0,
        unit="ohm",
        low=1.0,
        high=1e4,
        about="pre-charge resistor",
        source="dissertation, section 4.2: at most",
    )
    charged_share: float = setting(
        0.95,
        unit="1",
        low=0.5,
        high=0.999,
        about="of the supply voltage, at which the contactor closes",
    )
    precharge_timeout: float = setting(
        2.0, unit="s", low=0.01, high=60.0, about="longest pre-charge"
    )
    discharge_time: float = parameter(
        0.5, unit="s", low=1e-3, high=600.0, about="time constant of the discharge"
    )
    least_share: float = setting(
        0.7,
        unit="1",
        low=0.1,
        high=0.99,
        about="of the supply voltage, below which the DC link is lost",
    )
    highest_share: float = setting(
        1.25,
        unit="1",
        low=1.01,
        high=3.0,
        about="of the supply voltage, above which there is over-voltage",
    )

    def __post_init__(self) -> None:
        # A link that has just been charged must be clear of the voltage at which it counts as lost.
        if self.least_share >= 0.9 * self.charged_share:
            raise ParameterError("least_share must be below nine tenths of charged_share")


@dataclass(frozen=True, slots=True)
class LoadDcLinkParameters(DcLinkParameters):
    """The inverter of a load machine, fed from the mains; the source states nothing else."""

    supply_voltage: float = _as_in(
        DcLinkParameters, "supply_voltage", source="assumption: as for the other inverters"
    )
    precharge_resistance: float = _as_in(
        DcLinkParameters,
        "precharge_resistance",
        source="assumption: as in the other inverters, PM150, of which alone the source prints it",
    )


@dataclass(frozen=True, slots=True)
class InverterParameters:
    """One inverter and its machine, in torque control only, as the source's machines under test."""

    command_timeout: float = setting(
        0.01,
        unit="s",
        low=0.001,
        high=1.0,
        about="without a valid set-point for longer than this: fault",
    )
    machine: Machine = group(Machine)
    largest_current: float = parameter(
        600.0, unit="A", low=1.0, high=1000.0, about="rms phase current, above it over-current"
    )
    over_speed: float = parameter(
        1.05, unit="1", low=1.0, high=2.0, about="of the machine's maximum speed, above it a fault"
    )
    offers_speed_mode: bool = setting(
        False, about="whether its speed can be controlled, not only its torque"
    )
    speed_gain: float = parameter(
        1.0, unit="N m s/rad", low=0.0, high=1000.0, about="speed mode: proportional gain"
    )
    speed_integral_time: float = parameter(
        0.2, unit="s", low=1e-3, high=1e3, about="speed mode: integral time"
    )
    dc_link: DcLinkParameters = group(DcLinkParameters)
    thermal: ThermalParameters = group(ThermalParameters)


@dataclass(frozen=True, slots=True)
class LoadInverter(InverterParameters):
    """The inverter of a load machine: torque or speed."""

    machine: LoadMachine = group(LoadMachine)
    dc_link: LoadDcLinkParameters = group(LoadDcLinkParameters)
    offers_speed_mode: bool = _as_in(InverterParameters, "offers_speed_mode", default=True)


@dataclass(frozen=True, slots=True)
class CircuitParameters:
    """One circuit: a machine under test and a load machine on one shaft."""

    drive: InverterParameters = group(InverterParameters)
    load: LoadInverter = group(LoadInverter)
    friction: float = parameter(
        0.002, unit="N m s/rad", low=0.0, high=10.0, about="of the shaft, per speed"
    )


@dataclass(frozen=True, slots=True)
class InjectedFaults:
    """Faults that are put into the inverters, as long as they are set."""

    drive_11: tuple[str, ...] = setting((), choices=tuple(INJECTIONS), about="into the right drive")
    drive_12: tuple[str, ...] = setting((), choices=tuple(INJECTIONS), about="into the left drive")
    load_11: tuple[str, ...] = setting(
        (), choices=tuple(INJECTIONS), about="into the right load machine"
    )
    load_12: tuple[str, ...] = setting(
        (), choices=tuple(INJECTIONS), about="into the left load machine"
    )


@dataclass(frozen=True, slots=True)
class InverterNodeParameters(CircuitParameters):
    """Both circuits, their faults and their bus."""

    inject: InjectedFaults = group(InjectedFaults)
    bus: BusParameters = group(BusParameters)
