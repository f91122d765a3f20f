"""What lasts between two cycles of an inverter, and the faults that are put into it by name."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, fields
from types import MappingProxyType

from ev_core.bus.checking import CheckState
from ev_core.law import entry, part, series
from ev_msgs_py.can.frames import LONG_AGO


@dataclass(slots=True)
class Command:
    """The newest valid set-point."""

    controlword: float = entry(unit="1")
    mode: float = entry(unit="1")
    direction: float = entry(unit="1")
    torque: float = entry(unit="N m")
    speed: float = entry(unit="rad/s")
    torque_limit: float = entry(unit="N m")
    reset: float = entry(unit="1", about="the reset bit has risen, and nothing forbids it; until the next cycle")


@dataclass(slots=True)
class Supervision:
    """What has come since the newest valid set-point."""

    age: float = entry(LONG_AGO, unit="s", about="of the newest valid set-point")
    wrong_crc: float = entry(unit="1", about="frames with a wrong CRC since then")
    wrong_counter: float = entry(unit="1", about="frames with a repeated or wrong counter since then")
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
    remote: float = entry(1.0, unit="1", about="whether it follows its controlword: the operator's line releases it")
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
    weakening_loss: float = entry(unit="W", about="copper loss of the current that weakens the magnets")
    dc_current: float = entry(unit="A", about="from the supply")
    counters: list[float] = series(4, unit="1", about="of the next frame of each kind, in the order of SENT")


@dataclass(slots=True)
class Circuit:
    """A machine under test and a load machine on one shaft."""

    drive: Inverter = part(Inverter)
    load: Inverter = part(Inverter)
    speed: float = entry(unit="rad/s", about="of the shaft, forwards positive")
    tick: float = entry(unit="1", about="cycles of 1 ms since the start")


# Entry of `Injected` and the value that makes a fault of it, with the thresholds of the default parameters.
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


def inject(s: Injected, names: Iterable[str]) -> None:
    """Put these faults in, and take all others away."""
    for field in fields(s):
        setattr(s, field.name, 0.0)
    for name in names:
        entry, value = INJECTIONS[name]
        setattr(s, entry, value)
